#include "cli/flags/readback_flags.h"

#include <CLI/CLI.hpp>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "cli/flags/choice_option.h"
#include "cli/flags/frame_flag.h"
#include "cli/flags/number_checks.h"

namespace lightfit::cli {
namespace {

// A distance that may be infinite, by whatever name and in any case.
CLI::Option* AddDistance(CLI::App* app,
                         const std::string& flag,
                         double* distance,
                         const std::string& meaning) {
  const auto parse = [flag, distance](const std::string& text) {
    // Takes "inf" and "infinity" too; a sign before them makes them none that is positive.
    if (absl::SimpleAtod(text, distance) && *distance > 0.0) return;
    throw CLI::ValidationError(flag,
                               absl::StrCat("\"", text, "\", want a distance above 0, or inf"));
  };
  return app->add_option_function<std::string>(flag, parse, meaning)->type_name("DISTANCE|inf");
}

}  // namespace

void DeclareReadbackFlags(CLI::App* app, const std::string& group, FitFlags* flags) {
  AddChoice(app,
            "--depth-kind",
            DepthKindWords(),
            &flags->depth_kind,
            "What the depth channel holds [camera-z, or as the camera file says]")
      ->group(group);
  app->add_option("--background",
                  flags->background,
                  "Pixels at this depth or beyond are background; inf: none before 1e9 [one "
                  "greatest depth that many pixels share, far beyond the rest]")
      ->type_name("DEPTH")
      ->check(NumberAboveZeroOrInfinite())
      ->group(group);
  app->add_option("--depth-channel",
                  flags->depth_channel,
                  "Name of the depth channel, CHANNEL or PART.CHANNEL [Z, or what is called depth]")
      ->type_name("CHANNEL")
      ->group(group);
  app->add_option("--view",
                  flags->view,
                  "The view of a stereo file, such as left, that depth, shadows and camera are of "
                  "[the only one with a depth]")
      ->type_name("VIEW")
      ->group(group);
  app->add_option("--shadow-channel",
                  flags->shadow_channel_format,
                  "Name of the shadow channels; of layers that are parts, PART.CHANNEL such as "
                  "shadow_{light}.red [shadow.{light}]")
      ->type_name("FORMAT")
      ->group(group);
  app->add_option("--shadow-bits-channel",
                  flags->shadow_bits_channel,
                  "UINT channel that holds all shadows, light l in bit l")
      ->type_name("CHANNEL")
      ->group(group);
  app->add_option("--facing-channel",
                  flags->facing_channel_format,
                  "Name of the channels, where there are any, that say which surfaces face a light "
                  "[facing.{light}]")
      ->type_name("FORMAT")
      ->group(group);
  app->add_option("--mapped-channel",
                  flags->mapped_channel_format,
                  "Name of the channels, where there are any, that say what the map drawn with "
                  "says [mapped.{light}]")
      ->type_name("FORMAT")
      ->group(group);
}

void DeclareCoverReadbackFlag(CLI::App* app, const std::string& group, FitFlags* flags) {
  app->add_option(
         "--cover-readback",
         flags->cover_readback_path,
         "The same frame with more pixels, for things thinner than those of READBACK: they "
         "get room in the map where that makes fewer pixels wrong")
      ->type_name("FILE")
      ->check(CLI::ExistingFile)
      ->group(group);
}

void DeclareCameraFlags(CLI::App* app, const std::string& group, FitFlags* flags) {
  app->add_option("--camera", flags->camera_path, "JSON file with the camera, or a scene file")
      ->type_name("FILE")
      ->group(group);
  DeclareFrameFlag(
      app,
      group,
      "Which frame of the files of --camera and --lights, by its number, or where they have none "
      "counted from 0 [the read-back's own number]",
      &flags->frame);
  DeclareCameraExrFlags(app, group, &flags->camera_exr);
}

void DeclareCameraExrFlags(CLI::App* app, const std::string& group, CameraExrOptions* camera) {
  app->add_option_function<std::string>(
         "--camera-convention",
         [camera](const std::string& words) {
           const absl::StatusOr<CameraConvention> convention = ParseCameraConvention(words);
           if (!convention.ok()) {
             throw CLI::ValidationError("--camera-convention",
                                        std::string(convention.status().message()));
           }
           camera->convention = *convention;
         },
         "Who wrote worldToCamera and worldToNDC: openexr, mantra or pbrt; words such as "
         "column-vectors,y-up change it; shifted: the lens is [openexr]")
      ->type_name("WORDS")
      ->group(group);
  app->add_option("--near", camera->near, "Near clip plane, world units (NDC depth only)")
      ->type_name("DISTANCE")
      ->check(NumberAboveZero())
      ->group(group);
  AddDistance(app, "--far", &camera->far, "Far clip plane, world units, or inf (NDC depth only)")
      ->group(group);
  app->add_option(
         "--pixel-aspect", camera->pixel_aspect, "Width over height of a pixel [as the file says]")
      ->type_name("RATIO")
      ->check(NumberAboveZero())
      ->group(group);
}

}  // namespace lightfit::cli
