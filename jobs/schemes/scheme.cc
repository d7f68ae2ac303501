#include "jobs/schemes/scheme.h"

namespace lightfit {

namespace {

// One function for each kind of maps.
template <typename... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <typename... Visitors>
Overloaded(Visitors...) -> Overloaded<Visitors...>;

}  // namespace

const Plan* PlanOf(const SchemeMaps& maps) { return std::get_if<Plan>(&maps.maps); }

const PlanMap* OnlyMap(const SchemeMaps& maps) {
  const Plan* plan = PlanOf(maps);
  return plan != nullptr && plan->maps.size() == 1 ? plan->maps.data() : nullptr;
}

Border BorderOf(const SchemeMaps& maps) {
  const Plan* plan = PlanOf(maps);
  return plan != nullptr ? plan->border : Border::kLit;
}

int NumMaps(const SchemeMaps& maps) {
  return std::visit(
      Overloaded{[](const Plan& plan) { return static_cast<int>(plan.maps.size()); },
                 [](const ParaboloidPair&) { return 2; },
                 [](const RasterisedPair&) { return 2; },
                 [](const PagedMap& pages) { return static_cast<int>(pages.pages.size()); }},
      maps.maps);
}

int64_t NumTexels(const SchemeMaps& maps) {
  return std::visit(
      Overloaded{[](const RasterisedPair& rasterised) { return NumTexels(rasterised.pair); },
                 [](const auto& of_any) { return NumTexels(of_any); }},
      maps.maps);
}

absl::Status ValidateMaps(const SchemeMaps& maps, const Light& light) {
  const Plan* plan = PlanOf(maps);
  if (plan == nullptr) return absl::OkStatus();
  return PlanLookUp::Create(*plan, light, maps.guard_texels).status();
}

}  // namespace lightfit
