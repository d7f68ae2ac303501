// cli/flags/choice_option.h
//
// An option whose value is one of a few words, in any case and by whatever name is usual.
// In:   the table of its words (choices.h).
// Out:  the option; a wrong word is refused while parsing (exit code 1).
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/suggest.h"
#include "cli/flags/choices.h"

namespace lightfit::cli {

// CLI11's own transformer would also take the numbers behind the words.
template <typename Value, typename Target>
CLI::Option* AddChoice(CLI::App* app,
                       const std::string& flag,
                       const Words<Value>& words,
                       Target* target,
                       const std::string& meaning) {
  const auto parse = [flag, words, target](const std::string& text) {
    if (const Value* value = FindValue(words, text)) {
      *target = *value;
      return;
    }
    const std::vector<std::string> choices = WordsOnly(words);
    throw CLI::ValidationError(flag,
                               absl::StrCat("there is no \"",
                                            text,
                                            "\", want ",
                                            absl::StrJoin(choices, ", "),
                                            DidYouMean(PlainWord(text), choices)));
  };
  return app->add_option_function<std::string>(flag, parse, meaning)
      ->type_name(absl::StrJoin(WordsOnly(words), "|"));
}

}  // namespace lightfit::cli
