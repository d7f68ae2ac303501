#include "cli/flags/render_flags.h"

#include <CLI/CLI.hpp>

namespace lightfit::cli {
namespace {

constexpr char kExamples[] =
    "Examples:\n"
    "  lightfit render room.glb --camera -2.5,1.6,-3:2,0.8,2 --light lamp=point:-1,2,0 -o "
    "room.exr\n"
    "  lightfit render generate --camera 0,1.7,18:0,0.5,0 --random-lights 3 -o floor.exr \\\n"
    "      --lights-out floor.json --picture floor.png --picture-size 1280x720\n"
    "  lightfit fit floor.exr --lights floor.json\n"
    "\n"
    "Units: positions in world units, angles in degrees, images in pixels. The read-back holds\n"
    "depth along the view (Z), one channel shadow.LIGHT per light (1 where a surface that faces\n"
    "the light is in shadow) and the camera.";

void AddPixelSize(CLI::App* app,
                  const std::string& flag,
                  const std::string& meaning,
                  PixelSize* size) {
  app->add_option_function<std::string>(
         flag,
         [flag, size](const std::string& text) {
           const absl::StatusOr<PixelSize> parsed = ParsePixelSize(text);
           if (!parsed.ok()) {
             throw CLI::ValidationError(flag, std::string(parsed.status().message()));
           }
           *size = *parsed;
         },
         meaning)
      ->type_name("WIDTHxHEIGHT")
      ->group("Output");
}

}  // namespace

void DeclareRenderFlags(CLI::App* app, RenderFlags* flags) {
  DeclareSceneFlags(app, &flags->scene);
  const std::string group = "Output";
  app->add_option("-o,--output", flags->output_path, "Write the read-back to this file")
      ->type_name("FILE.exr")
      ->group(group);
  AddPixelSize(app,
               "--size",
               "Size of the read-back in pixels [180 high and as wide as the camera's file says; "
               "180x180 where it says nothing]",
               &flags->size);
  app->add_option("--lights-out",
                  flags->lights_path,
                  "Write the lights to this file, for lightfit fit --lights")
      ->type_name("FILE.json")
      ->group(group);
  app->add_option("--picture", flags->picture_path, "Draw the scene with the shadows of one light")
      ->type_name("FILE.png")
      ->group(group);
  AddPixelSize(
      app, "--picture-size", "Size of the picture in pixels [as --size]", &flags->picture_size);
  app->add_option("--picture-light", flags->picture_light, "Which light to draw [the first]")
      ->type_name("LIGHT")
      ->group(group);
  app->add_flag("-q,--quiet", flags->quiet, "No table and no progress; errors and warnings only")
      ->group(group);
  app->footer(kExamples);
}

}  // namespace lightfit::cli
