#include "cli/unusable_lights.h"

#include "cli/exit_code.h"

namespace lightfit::cli {

int PrintUnusable(const std::vector<ListedLight>& lights, absl::string_view what) {
  int num_unusable = 0;
  for (const ListedLight& listed : lights) {
    if (listed.status.ok()) continue;
    PrintFailedLight(what, listed.light.name, listed.status);
    ++num_unusable;
  }
  return num_unusable;
}

}  // namespace lightfit::cli
