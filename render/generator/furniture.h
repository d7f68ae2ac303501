// render/generator/furniture.h
//
// Pieces of furniture for a room made by rule.
// In:   Dice.
// Out:  Piece: how much floor it takes, and how it is built once it has a place.
#pragma once

#include <Eigen/Core>
#include <functional>

#include "render/generator/dice.h"
#include "render/generator/room_parts.h"

namespace lightfit {

// Its own coordinates: the middle of the floor it takes is the origin, x to its right, y up, z out
// of its front; metres.
struct Piece {
  Eigen::Vector2d half_size = Eigen::Vector2d::Zero();  // of the floor it takes, x and z
  bool at_wall = false;                                 // its back stands against a wall
  std::function<void(RoomParts*)> build;                // RoomParts::SetPlace() has been called
};

// A table with things on it and two to four chairs around.
Piece DiningTable(Dice* dice);

// A narrow table against a wall, with things on it.
Piece SideTable(Dice* dice);

// Boards between sides, some with books and vases on them; against a wall, or free without a back.
Piece Bookcase(Dice* dice);
Piece RoomDivider(Dice* dice);

// Two wings of upright slats.
Piece SlattedScreen(Dice* dice);

Piece FloorLamp(Dice* dice);
Piece Bench(Dice* dice);
Piece Armchair(Dice* dice);
Piece StackOfBoxes(Dice* dice);

// A ball, a drum, a vase or a ring.
Piece RoundThing(Dice* dice);

}  // namespace lightfit
