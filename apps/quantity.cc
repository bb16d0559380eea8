#include "apps/quantity.h"

#include "apps/text.h"

#include <fmt/format.h>
#include <udunits2.h>

#include <charconv>
#include <cmath>
#include <stdexcept>

namespace apps {

namespace {

struct Unit {
  ut_unit* unit;
  Unit(ut_system* system, const std::string& text)
      : unit(ut_parse(system, trimmed(text).c_str(), UT_UTF8))
  {
    if (!unit)
      throw std::invalid_argument(fmt::format("'{}' is not a known unit", trimmed(text)));
  }
  ~Unit() { ut_free(unit); }
  Unit(const Unit&) = delete;
};

struct Converter {
  cv_converter* converter;
  ~Converter() { cv_free(converter); }
};

/// The number at the start of a text and what follows it.
struct NumberAndRest {
  double value;
  std::string rest;
};

NumberAndRest split_number(std::string_view text)
{
  const std::string whole = trimmed(std::string(text));
  std::string_view digits = whole;
  if (digits.starts_with('+') && !digits.starts_with("+-"))
    digits.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range)
    throw std::invalid_argument(fmt::format("'{}' is out of the range of numbers", whole));
  if (error != std::errc() || !std::isfinite(value))
    throw std::invalid_argument(fmt::format("'{}' does not begin with a number", whole));
  const std::string rest = trimmed(std::string(end, digits.data() + digits.size()));
  if (rest.starts_with(','))
    throw std::invalid_argument(fmt::format("'{}': decimals are written with a point", whole));
  return {value, rest};
}

} // namespace

Units::Units()
{
  ut_set_error_message_handler(ut_ignore);
  system_.reset(ut_read_xml(nullptr));
  if (!system_)
    throw std::runtime_error("the unit database of UDUNITS-2 cannot be read; is libudunits2-data "
                             "installed?");
  const Unit degree(system_.get(), "degree"); // the unit of laboratories for phase angles
  ut_map_name_to_unit("deg", UT_ASCII, degree.unit);
}

Units::~Units() = default;

void Units::Free::operator()(ut_system* system) const
{
  ut_free_system(system);
}

bool Units::knows(const std::string& unit) const
{
  ut_unit* const read = ut_parse(system_.get(), unit.c_str(), UT_ASCII);
  ut_free(read);
  return read != nullptr;
}

double Units::convert(double value, const std::string& from, const std::string& to) const
{
  const Unit source(system_.get(), from), target(system_.get(), to);
  if (!ut_are_convertible(source.unit, target.unit))
    throw std::invalid_argument(fmt::format("'{}' cannot be converted to {}", trimmed(from), to));
  const Converter converter{ut_get_converter(source.unit, target.unit)};
  const auto at = [&](double number) { return cv_convert_double(converter.converter, number); };
  const double first = at(2) - at(1), second = at(3) - at(2);
  if (std::abs(second - first) > 1e-6 * std::abs(first)) // UDUNITS takes GPa for 1/Pa: reciprocals
    throw std::invalid_argument(fmt::format("'{}' cannot be converted to {}", trimmed(from), to));
  return cv_convert_double(converter.converter, value);
}

double Units::parse(std::string_view text, const std::string& unit,
                    const std::string& default_unit) const
{
  const auto [value, rest] = split_number(text);
  return convert(value, rest.empty() ? default_unit : rest, unit);
}

std::string unit_part(std::string_view text)
{
  return split_number(text).rest;
}

bool is_bare_number(std::string_view text)
{
  try {
    return unit_part(text).empty();
  } catch (const std::invalid_argument&) {
    return false;
  }
}

std::string shortest(double value)
{
  return fmt::format("{}", value);
}

} // namespace apps
