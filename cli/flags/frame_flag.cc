#include "cli/flags/frame_flag.h"

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"

namespace lightfit::cli {

void DeclareFrameFlag(CLI::App* app,
                      const std::string& group,
                      const std::string& meaning,
                      std::optional<FrameNumber>* frame) {
  app->add_option_function<std::string>(
         "--frame",
         [frame](const std::string& text) {
           *frame = ParseFrameNumber(text);
           if (!frame->has_value()) {
             throw CLI::ValidationError("--frame",
                                        absl::StrCat("\"", text, "\": want a number such as 1001"));
           }
         },
         meaning)
      ->type_name("N")
      ->group(group);
}

}  // namespace lightfit::cli
