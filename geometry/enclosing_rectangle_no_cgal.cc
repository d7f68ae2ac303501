#include "geometry/enclosing_rectangle.h"

namespace lightfit {

absl::StatusOr<Parallelogram> MinAreaRectangleCgal(const Polygon&) {
  return absl::UnimplementedError(
      "this build has no CGAL (LIGHTFIT_WITH_CGAL=OFF); the fitter kMinAreaRectangle gives the "
      "same "
      "rectangle without it");
}

}  // namespace lightfit
