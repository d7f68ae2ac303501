// partition/published/face_cells.h
//
// The view frustum split by its faces as the light sees them.
// In:      a light; the view; into how many parts each side face is split.
// Out:     FaceCell: per part of a face the beams of light that pass through it.
//
// Lloyd et al. 2006, 5.1 and 5.2. Pixels' beams are narrowest where a beam of light enters the view
// when it travels with the view's direction, and where it leaves when it travels against it. So the
// faces that face the light count in the first case and those that face away in the second, and
// every beam through the view passes just one of them. Cells are bounded by planes through the
// light and an edge between two faces, or a line of constant depth on a face: a receiver belongs to
// the cell of the face point that lies on its ray of light, wherever it stands. The side faces'
// planes pass through the eye. The near plane has no cell: the sides are stretched to the eye, as
// the paper suggests, unless it is asked for.
//
// Edge cases: a face that the light sees edge-on has no beams and no cell; from a light that sees
// none of the sides (a lamp between eye and near plane) the whole view is one cell. Differs from
// the paper in having lamps: those in front of the far plane count as travelling with the view, and
// from within the view all six faces have cells, of which the near and the far one are not split.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "geometry/camera.h"
#include "geometry/light.h"

namespace lightfit {

struct FaceCell {
  int side = -1;  // of the image, around it: top, right, bottom, left; -1: not a side face
  int part = 0;   // of the side, from the viewer outwards
  std::vector<Eigen::Vector4d> half_spaces;  // through the light; inside is >= 0

  // Of a side face the view's edges on both sides of it: unit, away from the eye.
  std::array<Eigen::Vector3d, 2> edges = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
};

// A perspective camera with 0 < near < far; num_parts >= 1, at equal ratios of depth. Sides first,
// then the near and the far face, if they have cells.
std::vector<FaceCell> FaceCells(const Light& light,
                                const Camera& camera,
                                int num_parts,
                                bool has_near_face);

}  // namespace lightfit
