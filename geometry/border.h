// geometry/border.h
//
// What a look-up outside a light's shadow map finds.
#pragma once

namespace lightfit {

// One sampler state: the border's colour (depth far or near), or the answer of the branch that
// looks whether a point is inside.
enum class Border {
  kLit,  // light: every shadowed surface needs room in the map
  kDark  // shadow: every lit surface does
};

inline const char* BorderName(Border border) { return border == Border::kLit ? "lit" : "dark"; }

// What a fit is asked for.
enum class BorderChoice {
  kLit,
  kDark,
  kAutomatic  // that of the fewer wrong pixels foretold, where the read-back tells which surfaces
              // face the light; else lit
};

}  // namespace lightfit
