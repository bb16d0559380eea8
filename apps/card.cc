#include "apps/card.h"

#include "apps/files.h"
#include "apps/run.h"
#include "apps/specimen.h"
#include "apps/text.h"

#include "coupling/material_cards.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <stdexcept>

namespace apps {

namespace {

/// The format of a name; nothing for pfc, which is no format of continuum laws.
std::optional<coupling::NamedCardFormat> format_of(const std::string& name)
{
  std::vector<std::string> names;
  for (const coupling::NamedCardFormat& format : coupling::card_formats()) {
    if (format.name == name)
      return format;
    names.push_back(format.name);
  }
  if (name == "pfc")
    return {};
  names.push_back("pfc");
  const std::string close = nearest(name, names);
  throw std::invalid_argument(
      fmt::format("there is no format '{}'; formats: {}{}", name, fmt::join(names, ", "),
                  close.empty() ? "" : fmt::format("; did you mean '{}'?", close)));
}

coupling::CardUnits units_of(const std::string& name)
{
  for (const coupling::CardUnits& units : {coupling::si_units(), coupling::millimetre_units()})
    if (units.name == name)
      return units;
  throw std::invalid_argument(
      fmt::format("there are no units '{}': say si (m, kg, s, Pa) or mm (mm, t, s, MPa)", name));
}

/// The first bond law of a scene at the temperature of its test.
coupling::ContactCard contact_card(const CardOptions& options)
{
  const LoadedScene loaded = load_scene(options.source, {});
  print_diagnostics(loaded.diagnostics);
  if (loaded.has_errors())
    throw std::invalid_argument(fmt::format("{}: the scene has errors", options.source));
  const auto laws = bond_laws(*loaded.scene, viscosity_shift(*loaded.scene));
  return coupling::pfc_card(laws.at(0), loaded.scene->friction,
                            Units().parse(options.time, "s", "s"));
}

} // namespace

int card_verb(const CardOptions& options)
{
  const std::optional<coupling::NamedCardFormat> format = format_of(options.format);
  const coupling::CardUnits units = units_of(options.units);
  if (!std::filesystem::exists(options.source))
    throw std::invalid_argument(fmt::format("{}: there is no such file", options.source));
  const std::filesystem::path folder =
      options.output.empty()
          ? std::filesystem::path(options.source).stem().string() + "-" + options.format
          : options.output;
  require_writable(folder);
  std::vector<coupling::CardFile> files;
  std::string limits;
  if (format) {
    const std::string text = read_text_file(options.source);
    coupling::MaterialCard card =
        coupling::material_card(fem::law_from_text(text, options.source), format->format, units);
    files = std::move(card.files);
    limits = files.back().text;
  } else {
    coupling::ContactCard card = contact_card(options);
    files = std::move(card.files);
    limits = card.limits + "\n";
    files.push_back({"note.txt", limits});
  }
  make_folder(folder);
  for (const coupling::CardFile& file : files) {
    write_text_file(folder / file.name, file.text);
    fmt::print("{}\n", (folder / file.name).string());
  }
  std::ranges::replace(limits, '\n', ' ');
  fmt::print("{}", wrapped(trimmed(limits), 100, ""));
  return exit_ok;
}

} // namespace apps
