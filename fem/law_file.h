#pragma once
#include "fem/compliance_law.h"
#include "fem/temperature_shift.h"

#include <optional>
#include <string>
#include <vector>

namespace fem {

/// A law with what must be known to use it.
struct LawRecord {
  ComplianceLaw law;                     ///< at the reference temperature
  double reference_temperature = 293.15; ///< [K]
  TemperatureShift shift;
  double first_time = 0, last_time = 0; ///< reduced times in which the law was seen [s]
  std::optional<std::pair<double, double>> temperatures; ///< range in which it was seen [K]
  double relative_error = 0;                             ///< rms of the fit [-]
  std::vector<std::string> provenance;                   ///< one line each: data, program, date
};

/// The text of a law file: a first line with the version, then `key = value` lines with the unit in
/// the key, matrices as six rows (Mandel, order 11 22 33 23 13 12), and `end`. Numbers carry as
/// many digits as give them back exactly. Lines that begin with # are comments. \throws
/// std::invalid_argument if a line of the provenance contains a line break
std::string law_text(const LawRecord& record);

/// Reads the text of a law file.
/// \param name  of the file, for messages
/// \throws std::invalid_argument "NAME:LINE: ..." for another version, an unknown, repeated or
///         missing key, a number that is none, a text that is cut off, or a law that
///         `make_compliance_law` refuses
LawRecord law_from_text(const std::string& text, const std::string& name);

} // namespace fem
