#include "fem/law_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>

namespace fem {

namespace {

constexpr const char* version_line = "mastic law 1";

const char* const notes =
    "# S(t) = S_0 + t S_v + sum of S_k (1 - exp(-t / tau_k)), t the reduced time "
    "t / a_T.\n"
    "# Mandel notation: order 11 22 33 23 13 12, shear times sqrt(2).\n";

std::string numbers(const std::vector<double>& values)
{
  std::string text;
  for (const double value : values)
    text += fmt::format("{}{}", text.empty() ? "" : " ", value);
  return text;
}

std::string matrix_text(const Mat6& matrix)
{
  std::string text;
  for (Eigen::Index i = 0; i < 6; ++i) {
    text += " ";
    for (Eigen::Index j = 0; j < 6; ++j)
      text += fmt::format(" {}", matrix(i, j) + 0.0); // no "-0"
    text += "\n";
  }
  return text;
}

std::string shift_text(std::monostate)
{
  return "none";
}

std::string shift_text(const WlfShift& shift)
{
  return "wlf " + numbers({shift.c1, shift.c2});
}

std::string shift_text(const ArrheniusShift& shift)
{
  return "arrhenius " + numbers({shift.activation_energy});
}

std::string shift_text(const FreeShift& shift)
{
  std::vector<double> pairs;
  for (std::size_t i = 0; i < shift.temperatures.size(); ++i)
    pairs.insert(pairs.end(), {shift.temperatures[i], shift.log10_factors[i]});
  return "free " + numbers(pairs);
}

/// Lines of the text with their numbers, comments and empty lines left out.
class Lines {
public:
  Lines(const std::string& text, const std::string& name) : name_(name)
  {
    std::istringstream stream(text);
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) {
      if (!line.empty() && line.back() == '\r')
        line.pop_back();
      if (line.find_first_not_of(' ') != std::string::npos && line.front() != '#')
        lines_.emplace_back(number, line);
    }
    last_ = lines_.empty() ? 1 : lines_.back().first;
  }

  bool done() const { return at_ == lines_.size(); }

  std::string next()
  {
    if (done())
      throw std::invalid_argument(
          fmt::format("{}:{}: the law file is cut off here: no line 'end'", name_, last_));
    return lines_[at_++].second;
  }

  [[noreturn]] void refuse(const std::string& what) const
  {
    const int line = at_ == 0 ? 1 : lines_[at_ - 1].first;
    throw std::invalid_argument(fmt::format("{}:{}: {}", name_, line, what));
  }

private:
  std::string name_;
  std::vector<std::pair<int, std::string>> lines_;
  std::size_t at_ = 0;
  int last_ = 1;
};

std::vector<double> numbers_of(const Lines& lines, const std::string& text, std::size_t n)
{
  std::vector<double> result;
  std::istringstream stream(text);
  for (std::string word; stream >> word;) {
    double value = 0;
    const auto [end, problem] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (problem != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
      lines.refuse(fmt::format("'{}' is not a finite number", word));
    result.push_back(value);
  }
  if (n > 0 && result.size() != n)
    lines.refuse(
        fmt::format("{} number{} expected, found {}", n, n == 1 ? "" : "s", result.size()));
  return result;
}

Mat6 matrix_of(Lines& lines)
{
  Mat6 matrix;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const std::string row = lines.next();
    if (row == "end")
      lines.refuse("a matrix has six rows of six numbers");
    const std::vector<double> entries = numbers_of(lines, row, 6);
    matrix.row(i) = Eigen::Map<const Eigen::Matrix<double, 1, 6>>(entries.data());
  }
  return matrix;
}

TemperatureShift shift_of(const Lines& lines, const std::string& text, double reference)
{
  const std::size_t space = text.find(' ');
  const std::string kind = text.substr(0, space);
  const std::string rest = space == std::string::npos ? "" : text.substr(space);
  if (kind == "none" && rest.empty())
    return {};
  if (kind == "wlf") {
    const auto values = numbers_of(lines, rest, 2);
    return WlfShift{values[0], values[1], reference};
  }
  if (kind == "arrhenius")
    return ArrheniusShift{numbers_of(lines, rest, 1)[0], reference};
  if (kind != "free")
    lines.refuse(fmt::format("unknown shift '{}'; known: none, wlf, arrhenius, free", kind));
  const auto pairs = numbers_of(lines, rest, 0);
  FreeShift shift{{}, {}, reference};
  for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
    if (i > 0 && pairs[i] <= pairs[i - 2])
      lines.refuse("the temperatures of a free shift must rise");
    shift.temperatures.push_back(pairs[i]);
    shift.log10_factors.push_back(pairs[i + 1]);
  }
  if (pairs.empty() || pairs.size() % 2 != 0)
    lines.refuse("a free shift is pairs of temperature [K] and log10 a_T");
  return shift;
}

/// What the keys fill in; a law is made of it at the end.
struct Draft {
  LawRecord record;
  Mat6 instantaneous, fluidity;
  std::vector<RetardationTerm> terms;
  std::string shift = "none";
  std::map<std::string, int> seen;
};

void read_key(Lines& lines, Draft& draft, const std::string& key, const std::string& value)
{
  LawRecord& record = draft.record;
  const auto one = [&] { return numbers_of(lines, value, 1)[0]; };
  const auto two = [&] { return numbers_of(lines, value, 2); };
  const bool many = key == "provenance" || key == "retardation time [s]";
  if (draft.seen[key]++ > 0 && !many)
    lines.refuse(fmt::format("the key '{}' occurs twice", key));
  if (key == "provenance")
    record.provenance.push_back(value);
  else if (key == "reference temperature [K]")
    record.reference_temperature = one();
  else if (key == "shift")
    draft.shift = value;
  else if (key == "valid reduced time [s]") {
    record.first_time = two()[0];
    record.last_time = two()[1];
  } else if (key == "valid temperature [K]")
    record.temperatures = {two()[0], two()[1]};
  else if (key == "relative error")
    record.relative_error = one();
  else if (key == "instantaneous compliance S_0 [1/Pa]")
    draft.instantaneous = matrix_of(lines);
  else if (key == "fluidity S_v [1/(Pa s)]")
    draft.fluidity = matrix_of(lines);
  else if (key == "retardation time [s]") {
    const double time = one();
    if (lines.next() != "compliance S_k [1/Pa] =")
      lines.refuse("'compliance S_k [1/Pa] =' expected after a retardation time");
    draft.terms.push_back({time, matrix_of(lines)});
  } else
    lines.refuse(fmt::format("unknown key '{}'", key));
}

} // namespace

std::string law_text(const LawRecord& record)
{
  std::string text = fmt::format("{}\n{}", version_line, notes);
  for (const std::string& line : record.provenance) {
    if (line.find_first_of("\r\n") != std::string::npos)
      throw std::invalid_argument("law file: a line of the provenance contains a line break");
    text += fmt::format("provenance = {}\n", line);
  }
  text += fmt::format("reference temperature [K] = {}\n", record.reference_temperature);
  text += fmt::format("shift = {}\n",
                      std::visit([](const auto& each) { return shift_text(each); }, record.shift));
  text += fmt::format("valid reduced time [s] = {} {}\n", record.first_time, record.last_time);
  if (record.temperatures)
    text += fmt::format("valid temperature [K] = {} {}\n", record.temperatures->first,
                        record.temperatures->second);
  text += fmt::format("relative error = {}\n", record.relative_error);
  text += "instantaneous compliance S_0 [1/Pa] =\n" + matrix_text(record.law.instantaneous);
  text += "fluidity S_v [1/(Pa s)] =\n" + matrix_text(record.law.fluidity);
  for (const auto& [time, part] : record.law.terms)
    text += fmt::format("retardation time [s] = {}\ncompliance S_k [1/Pa] =\n{}", time,
                        matrix_text(part));
  return text + "end\n";
}

LawRecord law_from_text(const std::string& text, const std::string& name)
{
  Lines lines(text, name);
  if (lines.next() != version_line)
    lines.refuse(
        fmt::format("not a law file of this version: the first line must be '{}'", version_line));
  Draft draft;
  for (std::string line = lines.next(); line != "end"; line = lines.next()) {
    const std::size_t sign = line.find('=');
    if (sign == std::string::npos)
      lines.refuse("'key = value' expected");
    const auto part = [&](std::size_t from, std::size_t to) {
      const std::size_t first = line.find_first_not_of(' ', from);
      const std::size_t last = line.find_last_not_of(' ', to);
      return first == std::string::npos || first > last ? std::string()
                                                        : line.substr(first, last - first + 1);
    };
    read_key(lines, draft, sign == 0 ? "" : part(0, sign - 1),
             sign + 1 < line.size() ? part(sign + 1, line.size() - 1) : "");
  }
  for (const char* key : {"reference temperature [K]", "valid reduced time [s]",
                          "instantaneous compliance S_0 [1/Pa]", "fluidity S_v [1/(Pa s)]"})
    if (!draft.seen.contains(key))
      lines.refuse(fmt::format("the key '{}' is missing", key));
  draft.record.shift = shift_of(lines, draft.shift, draft.record.reference_temperature);
  if (!lines.done()) {
    lines.next();
    lines.refuse("nothing may follow 'end'");
  }
  try {
    draft.record.law = make_compliance_law(draft.instantaneous, draft.fluidity, draft.terms);
  } catch (const std::invalid_argument& problem) {
    lines.refuse(problem.what());
  }
  return draft.record;
}

} // namespace fem
