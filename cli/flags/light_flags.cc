#include "cli/flags/light_flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "io/lights_file.h"
#include "wire/light_proto.h"

namespace lightfit::cli {

void DeclareLightFlags(CLI::App* app, LightFlags* flags, const std::string& group) {
  app->add_option("--lights", flags->path, "JSON file with the lights")
      ->type_name("FILE")
      ->group(group);
  app->add_option_function<std::vector<std::string>>(
         "--light",
         [flags](const std::vector<std::string>& texts) {
           for (const std::string& text : texts) {
             absl::StatusOr<Light> light = ParseLight(text);
             if (!light.ok()) {
               throw CLI::ValidationError("--light", std::string(light.status().message()));
             }
             flags->extra.push_back(*std::move(light));
           }
         },
         "A light: where it is, or the direction in which it travels")
      ->type_name("NAME=point:X,Y,Z|NAME=sun:X,Y,Z")
      ->expected(1)
      ->take_all()
      ->group(group);
}

absl::StatusOr<std::vector<ListedLight>> ListLights(const LightFlags& flags) {
  std::vector<ListedLight> lights;
  if (!flags.path.empty()) {
    absl::StatusOr<std::vector<ListedLight>> from_file = ReadLightList(flags.path);
    if (!from_file.ok()) return from_file.status();
    lights = *std::move(from_file);
  }
  for (const Light& light : flags.extra) {
    const auto has_name = [&light](const ListedLight& other) {
      return other.light.name == light.name;
    };
    const auto same = std::find_if(lights.begin(), lights.end(), has_name);
    if (same == lights.end()) {
      lights.push_back({light, absl::OkStatus()});
    } else {
      *same = {light, absl::OkStatus()};
      lights.erase(std::remove_if(same + 1, lights.end(), has_name), lights.end());
    }
  }
  for (size_t i = 0; i < lights.size(); ++i) lights[i].light.shadow_bit = static_cast<int>(i);
  return lights;
}

absl::StatusOr<std::vector<Light>> ReadLights(const LightFlags& flags) {
  absl::StatusOr<std::vector<ListedLight>> list = ListLights(flags);
  if (!list.ok()) return list.status();
  std::vector<Light> lights;
  for (ListedLight& listed : *list) {
    if (!listed.status.ok()) continue;
    lights.push_back(std::move(listed.light));
    lights.back().shadow_bit = static_cast<int>(lights.size()) - 1;
  }
  if (lights.empty() && !list->empty()) return list->front().status;
  if (absl::Status status = ValidateLights(lights); !status.ok()) return status;
  return lights;
}

}  // namespace lightfit::cli
