#include "man_page.h"

#include <algorithm>

namespace diminish {
namespace {

constexpr const char* exit_status =
    ".SH EXIT STATUS\n"
    ".TP\n0\nDone.\n"
    ".TP\n1\nAn error: one line that names file, key or camera, and what was expected.\n"
    ".TP\n2\nWrong usage.\n"
    ".TP\n3\nDone, but with problems, which were named.\n"
    ".TP\n130\nInterrupted; what was written is complete.\n";

std::string page_title(const CommandTree& command) {
  std::string title = command.path;
  std::replace(title.begin(), title.end(), ' ', '-');
  return title;
}

/// Text as man shows it: nothing in it is an instruction.
std::string text(const std::string& plain) {
  std::string result;
  for (const char letter : plain) {
    const bool starts_line = result.empty() || result.back() == '\n';
    if (starts_line && (letter == '.' || letter == '\'')) result += "\\&";
    if (starts_line && letter == ' ') continue;
    if (letter == '\\') {
      result += "\\e";
    } else if (letter == '-') {
      result += "\\-";
    } else {
      result += letter;
    }
  }
  return result;
}
std::string bold(const std::string& plain) {
  return "\\fB" + text(plain) + "\\fR";
}
std::string italic(const std::string& plain) {
  return "\\fI" + text(plain) + "\\fR";
}

std::string sentence(const std::string& plain) {
  const bool ends = plain.empty() || plain.back() == '.' || plain.back() == ')';
  return text(plain) + (ends ? "" : ".");
}

std::string synopsis(const CommandTree& command) {
  std::string line = bold(command.path);
  bool has_more = false;
  for (const CommandOption& option : command.options) {
    if (option.is_argument()) {
      const std::string more = option.repeated ? " ..." : "";
      line += option.required ? " " + italic(option.value) + more
                              : " [" + italic(option.value) + more + "]";
    } else if (option.required) {
      line += " " + bold(option.names.back()) + " " + italic(option.value);
    } else {
      has_more = true;
    }
  }
  if (has_more) line += " [" + italic("options") + "]";
  if (!command.commands.empty()) line += " " + italic("command") + " ...";
  return line;
}

std::string list_of(const CommandOption& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + bold(name);
  if (option.is_argument()) return italic(option.value);
  return option.is_switch() ? names : names + " " + italic(option.value);
}

std::string explanation(const CommandOption& option) {
  std::string result = sentence(option.help);
  if (!option.choices.empty()) {
    result += "\nOne of";
    for (const std::string& choice : option.choices) {
      result += (&choice == &option.choices.front() ? " " : ", ") + bold(choice);
    }
    result += ".";
  }
  if (!option.range.empty()) result += "\nFrom " + text(option.range) + ".";
  if (!option.fallback.empty()) result += "\nDefault: " + text(option.fallback) + ".";
  if (option.required && !option.is_argument()) result += "\nRequired.";
  if (option.repeated && !option.is_argument()) result += "\nMay be repeated.";
  return result;
}

std::string options(const CommandTree& command, bool arguments) {
  std::string result;
  std::string group;
  for (const CommandOption& option : command.options) {
    if (option.is_argument() != arguments) continue;
    if (!arguments && option.group != group) {
      const bool general = option.group == "Options";
      result += general ? "" : ".SS " + text(option.group) + "\n";
      group = option.group;
    }
    result += ".TP\n" + list_of(option) + "\n" + explanation(option) + "\n";
  }
  return result;
}

}  // namespace

std::string man_page_name(const CommandTree& command) {
  return page_title(command) + ".1";
}

std::string man_page(const CommandTree& command) {
  const std::string title = page_title(command);
  std::string upper = title;
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](char letter) { return letter >= 'a' && letter <= 'z' ? letter - 32 : letter; });
  const std::string first_line = command.help.substr(0, command.help.find('\n'));
  std::string page = ".TH " + text(upper) + " 1 \"\" \"diminish " DIMINISH_VERSION "\"\n" +
                     ".SH NAME\n" + text(title) + " \\- " + text(first_line) + "\n" +
                     ".SH SYNOPSIS\n" + synopsis(command) + "\n" + ".SH DESCRIPTION\n" +
                     sentence(command.help) + "\n";
  if (!command.footer.empty()) page += ".PP\n" + text(command.footer) + "\n";
  if (!command.commands.empty()) {
    page += ".SH COMMANDS\n";
    for (const CommandTree& below : command.commands) {
      page += ".TP\n" + bold(page_title(below)) + "(1)\n" + sentence(below.help) + "\n";
    }
  }
  const std::string arguments = options(command, true);
  if (!arguments.empty()) page += ".SH ARGUMENTS\n" + arguments;
  page += ".SH OPTIONS\n" + options(command, false);
  page += exit_status;
  const std::string parent = command.path.substr(0, command.path.rfind(' '));
  if (parent != command.path) {
    page += ".SH SEE ALSO\n" + bold(page_title({.path = parent})) + "(1)\n";
  }
  return page;
}

}  // namespace diminish
