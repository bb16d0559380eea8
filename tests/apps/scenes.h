#pragma once
#include "apps/scene.h"

#include <algorithm>
#include <string>
#include <vector>

/// Scenes from texts, and what is said about them.
namespace scenes {

inline apps::LoadedScene load(const std::string& text,
                              const std::vector<std::string>& overrides = {})
{
  return apps::load_scene_text(text, "a.scene", ".", overrides);
}

inline std::vector<std::string> messages(const apps::LoadedScene& scene,
                                         apps::Diagnostic::Kind kind)
{
  std::vector<std::string> lines;
  for (const apps::Diagnostic& each : scene.diagnostics)
    if (each.kind == kind)
      lines.push_back(each.place + ": " + each.message);
  return lines;
}

/// "place: message" of all errors.
inline std::vector<std::string> errors(const apps::LoadedScene& scene)
{
  return messages(scene, apps::Diagnostic::Kind::error);
}

inline std::vector<std::string> warnings(const apps::LoadedScene& scene)
{
  return messages(scene, apps::Diagnostic::Kind::warning);
}

inline std::vector<std::string> notes(const apps::LoadedScene& scene)
{
  return messages(scene, apps::Diagnostic::Kind::note);
}

/// Errors of a scene of single keys "Section/Key = value".
inline std::vector<std::string> errors_of(const std::vector<std::string>& settings)
{
  return errors(load("", settings));
}

} // namespace scenes
