#include "coupling/volume_points.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace coupling {

namespace {

constexpr std::size_t statuses_per_number = 24; ///< two bits each, exact in a double
constexpr std::size_t n_fields = 5;             ///< of six numbers
constexpr std::size_t n_scalars = 4;            ///< is it live, since when; pace; is it released

std::size_t most_bonds(const std::vector<VolumeFamily>& families)
{
  std::size_t n = 0;
  for (const VolumeFamily& family : families)
    n = std::max(n, family.element->n_bonds());
  return n;
}

} // namespace

std::size_t VolumePoints::numbers_per_point() const
{
  const std::size_t packed =
      (most_bonds(families_) + statuses_per_number - 1) / statuses_per_number;
  return 6 * (n_fields + creep_.n_branches()) + n_scalars + packed + StrainWindow::n_numbers;
}

void VolumePoints::store(std::size_t point, std::span<double> numbers) const
{
  assert(numbers.size() >= numbers_per_point());
  std::ranges::fill(numbers, 0);
  auto to = numbers.begin();
  for (const auto* field : {&strain_, &stress_, &elastic_, &slope_, &jumps_})
    to = std::copy_n((*field)[point].data(), 6, to);
  for (const fem::Vec6& branch : kelvin(point))
    to = std::copy_n(branch.data(), 6, to);
  const LiveVolume* volume = live(point);
  *to++ = volume ? 1 : 0;
  *to++ = volume ? volume->since : 0;
  *to++ = pace_;
  *to++ = is_released_[point];
  if (volume)
    for (std::size_t b = 0; b < volume->damage->status.size(); b += statuses_per_number) {
      double packed = 0, place = 1;
      for (std::size_t k = b; k < std::min(b + statuses_per_number, volume->damage->status.size());
           ++k, place *= 4)
        packed += place * double(volume->damage->status[k]);
      *(to + long(b / statuses_per_number)) = packed;
    }
  window_.store(point, numbers.last(StrainWindow::n_numbers));
}

void VolumePoints::restore(std::size_t point, std::span<const double> numbers)
{
  assert(numbers.size() >= numbers_per_point());
  auto from = numbers.begin();
  for (auto* field : {&strain_, &stress_, &elastic_, &slope_, &jumps_}) {
    std::copy_n(from, 6, (*field)[point].data());
    from += 6;
  }
  for (std::size_t k = 0; k < creep_.n_branches(); ++k, from += 6)
    std::copy_n(from, 6, kelvin_[point * creep_.n_branches() + k].data());
  const bool is_live = *from++ != 0;
  const double since = *from++;
  pace_ = *from++;
  is_released_[point] = char(*from++ != 0);
  if (is_live) {
    n_live_ += live_[point] ? 0 : 1;
    std::vector<dem::BondStatus> status(family(point).element->n_bonds());
    for (std::size_t b = 0; b < status.size(); b += statuses_per_number) {
      auto packed = std::uint64_t(*(from + long(b / statuses_per_number)));
      for (std::size_t k = b; k < std::min(b + statuses_per_number, status.size());
           ++k, packed /= 4)
        status[k] = dem::BondStatus(packed % 4);
    }
    looks_[point] = {};
    live_[point] = std::make_shared<const LiveVolume>(
        live_volume(family(point), family(point).element->answer(std::move(status)),
                    size_ratio_[point], since));
  }
  window_.restore(point, numbers.last(StrainWindow::n_numbers));
}

} // namespace coupling
