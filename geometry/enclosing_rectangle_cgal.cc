// The one source that includes CGAL.
#include <CGAL/Polygon_2.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/min_quadrilateral_2.h>

#include <iterator>

#include "geometry/enclosing_rectangle.h"

namespace lightfit {

absl::StatusOr<Parallelogram> MinAreaRectangleCgal(const Polygon& polygon) {
  using Kernel = CGAL::Simple_cartesian<double>;
  // CGAL checks nothing in release builds: a clockwise polygon would give area -1, NaN gives NaN.
  for (const Eigen::Vector2d& vertex : polygon) {
    if (!vertex.allFinite()) {
      return absl::InvalidArgumentError("polygon: a vertex is not finite");
    }
  }
  if (polygon.empty()) return Parallelogram{};
  if (polygon.size() < 3) {
    Parallelogram segment;
    segment.corner = polygon.front();
    segment.edge_u = polygon.back() - polygon.front();
    return segment;
  }
  CGAL::Polygon_2<Kernel> input, rectangle;
  for (const Eigen::Vector2d& vertex : polygon) input.push_back({vertex.x(), vertex.y()});
  CGAL::min_rectangle_2(
      input.vertices_begin(), input.vertices_end(), std::back_inserter(rectangle));
  const auto corner = [&rectangle](int i) {
    return Eigen::Vector2d(rectangle.vertex(i).x(), rectangle.vertex(i).y());
  };
  Parallelogram result;
  result.corner = corner(0);
  result.edge_u = corner(1) - corner(0);
  result.edge_v = corner(3) - corner(0);
  return result;
}

}  // namespace lightfit
