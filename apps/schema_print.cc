#include "apps/schema.h"
#include "apps/text.h"

#include <fmt/format.h>

namespace apps {

namespace {

/// A text as a cell of a Markdown table.
std::string cell(const std::string& text)
{
  std::string result;
  for (const char c : text)
    result += c == '|' ? std::string("\\|") : std::string(1, c);
  return result;
}

} // namespace

std::string Schema::print(bool comments) const
{
  std::string result;
  auto& handler = const_cast<dealii::ParameterHandler&>(handler_); // its cursor moves
  for (const auto& [section, text] : sections_) {
    const std::string indent = section.empty() ? "" : "  ";
    if (comments && !text.empty())
      result += wrapped(text, 96, "# ");
    if (!section.empty()) {
      result += "subsection " + section + "\n";
      handler.enter_subsection(section);
    }
    for (const Key& key : keys_) {
      if (key.section != section)
        continue;
      if (comments) {
        result += wrapped(key.text, 96, indent + "# ");
        result += wrapped(fmt::format("[{}; default: {}]", key.range,
                                      key.initial.empty() ? "empty" : key.initial),
                          96, indent + "# ");
      }
      result += fmt::format("{}set {} = {}\n", indent, key.name, handler.get(key.name));
      if (comments)
        result += "\n";
    }
    if (!section.empty()) {
      handler.leave_subsection();
      result += "end\n";
    }
    result += "\n";
  }
  return result;
}

std::string Schema::reference() const
{
  std::string result;
  for (const auto& [section, text] : sections_) {
    result += fmt::format("## {}\n\n", section.empty() ? "Before all sections" : section);
    if (!text.empty())
      result += text + "\n\n";
    result += "| key | default | values | meaning |\n|---|---|---|---|\n";
    for (const Key& key : keys_)
      if (key.section == section)
        result += fmt::format("| `{}` | {} | {} | {} |\n", key.name,
                              key.initial.empty() ? "" : "`" + cell(key.initial) + "`",
                              cell(key.range), cell(key.text));
    result += "\n";
  }
  return result;
}

} // namespace apps
