// cli/command_line/file_kinds.h
//
// What an option takes in the way of files, read off the word for its value that its declaration
// has: "FILE.json", "FOLDER|LIST|READBACK.exr", "NAME=FILE.json", "l1|l2".
// In:   an option as it was declared.
// Out:  OptionKind, for `-`, for the extensions of outputs and for completion.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class Option;
}

namespace lightfit::cli {

struct OptionKind {
  bool is_flag = false;    // takes nothing
  bool is_output = false;  // written rather than read

  bool has_file = false;
  bool has_folder = false;
  bool has_list = false;                // a text file with paths
  bool has_name = false;                // NAME=FILE
  std::vector<std::string> extensions;  // ".json"; with `has_file` and none of them: any file

  std::vector<std::string> choices;  // where the value is one of a few words
};

OptionKind KindOf(const CLI::Option& option);

// "JSON", "a PNG picture": what a file of this extension holds.
std::string ContentOf(const std::string& extension);

}  // namespace lightfit::cli
