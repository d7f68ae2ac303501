#include "cli/command_line/man_page.h"

#include <CLI/CLI.hpp>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "base/suggest.h"
#include "base/text_file.h"
#include "base/version.h"
#include "cli/command_line/declared.h"
#include "cli/command_line/file_kinds.h"

namespace lightfit::cli {
namespace {

// Text in roff: a dash is one that can be copied, and no line begins with a request.
std::string Roff(absl::string_view text) {
  std::string escaped = absl::StrReplaceAll(text, {{"\\", "\\e"}, {"-", "\\-"}});
  std::vector<std::string> lines = absl::StrSplit(escaped, '\n');
  for (std::string& line : lines) {
    if (!line.empty() && (line[0] == '.' || line[0] == '\'')) line.insert(0, "\\&");
  }
  return absl::StrJoin(lines, "\n");
}

std::string PageName(const CLI::App& app, const CLI::App& verb) {
  return &app == &verb ? app.get_name() : absl::StrCat(app.get_name(), "-", verb.get_name());
}

std::string Heading(const std::string& page) {
  return absl::StrCat(".TH ",
                      Roff(absl::AsciiStrToUpper(page)),
                      " 1 \"\" \"lightfit ",
                      kVersion,
                      "\" \"lightfit\"\n");
}

std::string NameSection(const std::string& page, const std::string& summary) {
  std::string lower = summary;
  if (!lower.empty()) lower[0] = absl::ascii_tolower(lower[0]);
  if (!lower.empty() && lower.back() == '.') lower.pop_back();
  return absl::StrCat(".SH NAME\n", Roff(page), " \\- ", Roff(lower), "\n");
}

// "-q, --quiet" or "--map WIDTHxHEIGHT", what it means.
std::string OptionEntry(const CLI::Option& option) {
  const std::vector<std::string> names = NamesOf(option);
  std::string text = ".TP\n";
  const bool has_value = !KindOf(option).is_flag;
  if (option.get_positional()) {
    absl::StrAppend(&text, "\\fI", Roff(ValueWord(option)), "\\fR");
  } else {
    std::vector<std::string> bold;
    bold.reserve(names.size());
    for (const std::string& name : names) bold.push_back(absl::StrCat("\\fB", Roff(name), "\\fR"));
    absl::StrAppend(&text, absl::StrJoin(bold, ", "));
    if (has_value) absl::StrAppend(&text, " \\fI", Roff(ValueWord(option)), "\\fR");
  }
  if (option.get_items_expected_max() > 1) absl::StrAppend(&text, " ...");
  std::vector<std::string> others;
  for (const CLI::Option* other : option.get_excludes()) others.push_back(other->get_name());
  return absl::StrCat(
      text,
      "\n",
      Roff(option.get_description()),
      others.empty() ? "" : absl::StrCat("\nNot with ", Roff(absl::StrJoin(others, ", ")), "."),
      "\n");
}

std::string OptionSections(const CLI::App& verb) {
  std::string text = ".SH OPTIONS\n";
  if (const CLI::Option* positional = DeclaredPositional(verb); positional != nullptr) {
    absl::StrAppend(&text, OptionEntry(*positional));
  }
  std::vector<std::string> groups;
  for (const CLI::Option* option : DeclaredOptions(verb)) {
    if (std::find(groups.begin(), groups.end(), option->get_group()) == groups.end()) {
      groups.push_back(option->get_group());
    }
  }
  for (const std::string& group : groups) {
    absl::StrAppend(&text, ".SS ", Roff(group), "\n");
    for (const CLI::Option* option : DeclaredOptions(verb)) {
      if (option->get_group() == group) absl::StrAppend(&text, OptionEntry(*option));
    }
  }
  return text;
}

// What the help ends with, line by line as it is.
std::string NotesSection(const std::string& footer) {
  return footer.empty() ? "" : absl::StrCat(".SH NOTES\n.nf\n", Roff(footer), "\n.fi\n");
}

std::string VerbPage(const CLI::App& app, const CLI::App& verb) {
  const std::string page = PageName(app, verb);
  const CLI::Option* positional = DeclaredPositional(verb);
  std::string synopsis = absl::StrCat("\\fBlightfit ", Roff(verb.get_name()), "\\fR");
  if (positional != nullptr) {
    const std::string word = absl::StrCat("\\fI",
                                          Roff(ValueWord(*positional)),
                                          "\\fR",
                                          positional->get_items_expected_max() > 1 ? " ..." : "");
    absl::StrAppend(
        &synopsis, " ", positional->get_required() ? word : absl::StrCat("[", word, "]"));
  }
  return absl::StrCat(Heading(page),
                      NameSection(page, verb.get_description()),
                      ".SH SYNOPSIS\n",
                      synopsis,
                      " [\\fIOPTIONS\\fR]\n",
                      OptionSections(verb),
                      NotesSection(verb.get_footer()),
                      ".SH SEE ALSO\n\\fBlightfit\\fR(1)\n");
}

std::string ProgramPage(const CLI::App& app) {
  std::string verbs, pages;
  for (const CLI::App* verb : DeclaredVerbs(app)) {
    absl::StrAppend(
        &verbs, ".TP\n\\fB", Roff(verb->get_name()), "\\fR\n", Roff(verb->get_description()), "\n");
    absl::StrAppend(
        &pages, pages.empty() ? "" : ",\n", "\\fB", Roff(PageName(app, *verb)), "\\fR(1)");
  }
  return absl::StrCat(Heading(app.get_name()),
                      NameSection(app.get_name(), app.get_description()),
                      ".SH SYNOPSIS\n\\fBlightfit\\fR \\fIVERB\\fR [\\fIOPTIONS\\fR]\n",
                      ".SH VERBS\n",
                      verbs,
                      OptionSections(app),
                      NotesSection(app.get_footer()),
                      ".SH SEE ALSO\n",
                      pages,
                      "\n");
}

}  // namespace

absl::StatusOr<std::string> ManPage(const CLI::App& app, const std::string& verb) {
  if (verb.empty()) return ProgramPage(app);
  std::vector<std::string> names;
  for (const CLI::App* declared : DeclaredVerbs(app)) {
    if (declared->get_name() == verb) return VerbPage(app, *declared);
    names.push_back(declared->get_name());
  }
  return absl::InvalidArgumentError(absl::StrCat("there is no verb \"",
                                                 verb,
                                                 "\", want one of ",
                                                 absl::StrJoin(names, ", "),
                                                 DidYouMean(verb, names)));
}

absl::Status WriteManPages(const CLI::App& app, const std::string& folder) {
  std::vector<std::string> verbs = {""};
  for (const CLI::App* verb : DeclaredVerbs(app)) verbs.push_back(verb->get_name());
  for (const std::string& verb : verbs) {
    const absl::StatusOr<std::string> page = ManPage(app, verb);
    if (!page.ok()) return page.status();
    const std::string path = absl::StrCat(folder, "/lightfit", verb.empty() ? "" : "-", verb, ".1");
    if (absl::Status status = WriteTextFileAtomically(path, *page); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace lightfit::cli
