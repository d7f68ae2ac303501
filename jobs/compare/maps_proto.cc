#include "jobs/compare/maps_proto.h"

#include "wire/matrix_proto.h"

namespace lightfit {

namespace {

// Row-major.
template <typename Matrix, typename Field>
void Append(const Matrix& matrix, Field* field) {
  for (int row = 0; row < matrix.rows(); ++row) {
    for (int column = 0; column < matrix.cols(); ++column) field->Add(matrix(row, column));
  }
}

void SetPlan(const Plan& plan, v1::MethodMaps* proto) {
  for (const PlanMap& map : plan.maps) {
    v1::MethodMap& added = *proto->add_plan();
    added.mutable_map()->set_width(map.size.width);
    added.mutable_map()->set_height(map.size.height);
    *added.mutable_map_from_world() = MatrixToProto(map.map_from_world);
    for (const Eigen::RowVector4d& half_space : map.half_spaces) {
      Append(half_space, added.add_half_spaces()->mutable_n());
    }
  }
}

void SetPair(const ParaboloidPair& pair, bool is_rasterised, v1::MethodMaps* proto) {
  v1::ParaboloidPair& paraboloids = *proto->mutable_paraboloids();
  Append(pair.centre, paraboloids.mutable_centre());
  Append(pair.normal, paraboloids.mutable_normal());
  paraboloids.set_size(pair.size);
  paraboloids.set_is_rasterised(is_rasterised);
}

void SetPages(const PagedMap& map, v1::MethodMaps* proto) {
  v1::MapPages& pages = *proto->mutable_pages();
  pages.set_page_side(map.page_side);
  Append(map.plane_from_world, pages.mutable_plane_from_world());
  pages.set_level_bias(map.level_bias);
  Append(map.depth_from_world, pages.mutable_depth_from_world());
  pages.set_pixel_per_depth(map.pixel_per_depth);
  pages.set_last_level(map.last_level);
  for (const MapPage& page : map.pages) {
    v1::MapPages::Page& added = *pages.add_pages();
    added.set_level(page.level);
    added.set_column(page.column);
    added.set_row(page.row);
  }
}

}  // namespace

v1::MethodMaps MapsToProto(const SchemeMaps& drawn) {
  v1::MethodMaps proto;
  proto.set_texels(NumTexels(drawn));
  proto.set_guard_texels(drawn.guard_texels);
  if (const Plan* plan = PlanOf(drawn)) SetPlan(*plan, &proto);
  if (const auto* pair = std::get_if<ParaboloidPair>(&drawn.maps)) SetPair(*pair, false, &proto);
  if (const auto* rasterised = std::get_if<RasterisedPair>(&drawn.maps)) {
    SetPair(rasterised->pair, true, &proto);
  }
  if (const auto* pages = std::get_if<PagedMap>(&drawn.maps)) SetPages(*pages, &proto);
  return proto;
}

}  // namespace lightfit
