#include "cli/flags/light_flags.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <utility>

#include "base/text_file.h"
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

absl::StatusOr<std::vector<Light>> ReadLights(const LightFlags& flags) {
  std::vector<Light> lights;
  if (!flags.path.empty()) {
    absl::StatusOr<std::vector<Light>> from_file =
        flags.json.empty() ? ReadLightsFile(flags.path) : ParseLightsJson(flags.json);
    if (!from_file.ok()) {
      return flags.json.empty() ? from_file.status() : InFile(flags.path, from_file.status());
    }
    lights = *std::move(from_file);
  }
  for (Light light : flags.extra) {
    const auto same = std::find_if(lights.begin(), lights.end(), [&light](const Light& other) {
      return other.name == light.name;
    });
    if (same != lights.end()) {
      light.shadow_bit = same->shadow_bit;
      *same = light;
    } else {
      light.shadow_bit = static_cast<int>(lights.size());
      lights.push_back(light);
    }
  }
  absl::Status status = ValidateLights(lights);
  if (!status.ok()) return status;
  return lights;
}

}  // namespace lightfit::cli
