#pragma once
#include "apps/schema.h"

#include <algorithm>
#include <string>
#include <vector>

namespace apps {

/// Collects what is wrong, each with the place of the key it is about.
class Findings {
public:
  explicit Findings(const Schema& schema) : schema_(schema) {}

  void tell(Diagnostic::Kind kind, const std::string& key, const std::string& message)
  {
    const auto found = schema_.set_keys().find(key);
    const std::string place =
        found != schema_.set_keys().end() ? found->second : key + " (not set)";
    const bool typed = found != schema_.set_keys().end();
    list.push_back(
        {kind, place, typed ? key.substr(key.rfind('/') + 1) + ": " + message : message});
  }
  void error(const std::string& key, const std::string& message)
  {
    tell(Diagnostic::Kind::error, key, message);
  }
  bool has_errors() const
  {
    return std::ranges::find(list, Diagnostic::Kind::error, &Diagnostic::kind) != list.end();
  }
  bool is_set(const std::string& key) const { return schema_.set_keys().contains(key); }

  std::vector<Diagnostic> list;

private:
  const Schema& schema_;
};

} // namespace apps
