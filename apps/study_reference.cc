#include "apps/study_reference.h"

#include "apps/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace apps {

namespace {

/// Motion up to which displacements count as small: strain, or displacement over size [-].
constexpr double small_motion = 0.02;

const StudyRow* finished_row(const std::vector<StudyRow>& rows, const std::string& solver)
{
  const auto found = std::ranges::find_if(rows, [&](const StudyRow& row) {
    return row.rung.solver == solver && row.rung.knob.empty() && row.curve.has_value();
  });
  return found == rows.end() ? nullptr : &*found;
}

bool stays_intact(const StudyRow& row)
{
  return !row.curve->rupture_time &&
         std::ranges::all_of(row.curve->n_broken, [](double n) { return n == 0; });
}

StudyReference small_displacements(const StudyRow& row, const std::string& what)
{
  return {row.rung,
          fmt::format("{}; it takes displacements as small: what it leaves out is at least of the "
                      "order of the largest strain, {:.2g} %",
                      what, 100 * row.motion),
          row.motion};
}

double largest(const std::vector<double>& values)
{
  double size = 0;
  for (const double value : values)
    size = std::max(size, std::abs(value));
  return size;
}

} // namespace

std::optional<StudyReference> exact_reference(const std::vector<StudyRow>& rows,
                                              const LoadedScene& scene)
{
  const StudyRow* events = finished_row(rows, "events");
  const StudyRow* linear = finished_row(rows, "linear");
  const bool may_be_large = scene.scene->quasistatic.geometry == dem::Geometry::finite;
  const auto is_small = [&](const StudyRow& row) {
    return !may_be_large || row.motion <= small_motion;
  };
  const bool intact =
      events ? stays_intact(*events) : scene.scene->strength.kind == StrengthKind::none;
  if (linear && intact && is_small(*linear))
    return small_displacements(*linear, "closed form, for no bond breaks");
  if (events && is_small(*events))
    return small_displacements(*events, "exact from breakage to breakage");
  return std::nullopt;
}

StudyReference finest_reference(const LoadedScene& scene)
{
  if (scene.scene->solver == SolverChoice::continuum && breaks(scene.scene->continuum))
    return {finest(*scene.scene),
            "every volume live, at a tenth of the breakage tolerance, on the same mesh; its own "
            "error is not known",
            std::nullopt};
  if (scene.scene->solver == SolverChoice::continuum)
    return {finest(*scene.scene),
            "cells of half the size and a tenth of the step tolerance; its own error is not known",
            std::nullopt};
  return {
      finest(*scene.scene),
      "a tenth of the scene's step and tolerance, one bond at a time; its own error is not known",
      std::nullopt};
}

std::optional<StudyReference> named_reference(const std::vector<StudyRow>& rows,
                                              const std::string& solver)
{
  std::optional<StudyReference> found;
  for (const StudyRow& row : rows) // ladders go from cheap to exact
    if (row.rung.solver == solver && row.curve &&
        (!found || row.rung.knob == found->rung.knob || row.rung.knob.starts_with("finest")))
      found = StudyReference{row.rung,
                             "the most exact of its settings here; its own error is not known",
                             std::nullopt};
  if (found && found->rung.knob.empty())
    return small_displacements(*finished_row(rows, solver), "no other was taken");
  return found;
}

double largest_motion(const dem::Hdf5File& result)
{
  const std::vector<std::string> columns = split(result.text_attribute("history", "columns"), ',');
  if (std::ranges::find(columns, "axial_strain_percent") != columns.end())
    return largest(result.read_doubles("history/axial_strain_percent")) / 100;
  if (!result.has("packing")) // a continuum under loads on its boundaries has no one size
    return 0;
  const std::vector<double> centres = result.read_doubles("packing/centre");
  const std::vector<double> radii = result.read_doubles("packing/radius");
  double size = 2 * largest(radii);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = centres[axis], high = low;
    for (std::size_t k = axis; k < centres.size(); k += 3) {
      low = std::min(low, centres[k]);
      high = std::max(high, centres[k]);
    }
    size = std::max(size, high - low);
  }
  return largest(result.read_doubles("history/mean_displacement_mm")) / 1e3 / size;
}

} // namespace apps
