#include "coupling/quasistatic_points.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>

// States of volumes as numbers: each point has room for as many links as can be near.

namespace coupling {

using dem::QuasistaticVolume;
using dem::QuasistaticVolumeState;

namespace {

constexpr std::size_t numbers_per_link = 19;  ///< and its memory
constexpr std::size_t n_scalars = 4;          ///< is it followed, since when, number of links; pace
constexpr std::size_t near_per_particle = 10; ///< pairs that are near each other, bonded or not

class Writer {
public:
  explicit Writer(std::span<double> numbers) : to_(numbers.begin()) {}
  void number(double value) { *to_++ = value; }
  template <typename Matrix>
  void matrix(const Matrix& values)
  {
    to_ = std::copy_n(values.data(), values.size(), to_);
  }
  void vectors(std::span<const dem::Vec3> all)
  {
    for (const dem::Vec3& each : all)
      matrix(each);
  }

private:
  std::span<double>::iterator to_;
};

class Reader {
public:
  explicit Reader(std::span<const double> numbers) : from_(numbers.begin()) {}
  double number() { return *from_++; }
  template <typename Matrix>
  void matrix(Matrix& values)
  {
    std::copy_n(from_, values.size(), values.data());
    from_ += values.size();
  }
  void vectors(std::vector<dem::Vec3>& all, std::size_t n)
  {
    all.resize(n);
    for (dem::Vec3& each : all)
      matrix(each);
  }

private:
  std::span<const double>::iterator from_;
};

void write_link(Writer& to, const dem::Link& link)
{
  for (const double each :
       {double(link.first), double(link.second), double(link.bond), double(link.law),
        double(link.kind), double(link.closed), link.offset, link.touch, link.distance, link.span})
    to.number(each);
  to.matrix(link.frame.normal);
  to.matrix(link.frame.tangent);
  to.matrix(dem::Vec3(link.image.cast<double>()));
}

dem::Link read_link(Reader& from)
{
  dem::Link link{};
  link.first = dem::Index(from.number());
  link.second = dem::Index(from.number());
  link.bond = dem::Index(from.number());
  link.law = int(from.number());
  link.kind = dem::LinkKind(int(from.number()));
  link.closed = from.number() != 0;
  for (double* each : {&link.offset, &link.touch, &link.distance, &link.span})
    *each = from.number();
  from.matrix(link.frame.normal);
  from.matrix(link.frame.tangent);
  dem::Vec3 image;
  from.matrix(image);
  link.image = image.cast<int>();
  return link;
}

void write_state(Writer& to, const QuasistaticVolumeState& state)
{
  for (const dem::Mat3* each : {&state.strain, &state.searched_at})
    to.matrix(*each);
  to.matrix(state.stress);
  to.vectors(state.centre);
  to.vectors(state.rotation);
  to.vectors(state.links.reference);
  for (const dem::Link& link : state.links.link)
    write_link(to, link);
  to.matrix(Eigen::Map<const Eigen::VectorXd>(state.links.memory.data(),
                                              Eigen::Index(state.links.memory.size())));
}

QuasistaticVolumeState read_state(Reader& from, const QuasistaticVolume& volume, int n_parts,
                                  std::size_t n_links)
{
  QuasistaticVolumeState state;
  for (dem::Mat3* each : {&state.strain, &state.searched_at})
    from.matrix(*each);
  from.matrix(state.stress);
  const std::size_t n = volume.bodies.radius.size();
  from.vectors(state.centre, n);
  from.vectors(state.rotation, n);
  from.vectors(state.links.reference, n);
  state.links.n_parts = n_parts;
  for (std::size_t k = 0; k < n_links; ++k)
    state.links.link.push_back(read_link(from));
  Eigen::VectorXd memory(Eigen::Index(n_links) * 6 * n_parts);
  from.matrix(memory);
  state.links.memory.assign(memory.begin(), memory.end());
  return state;
}

int parts_of(const QuasistaticVolume& volume)
{
  std::size_t n = 0;
  for (const dem::BondLaw& law : volume.assembly.laws)
    n = std::max(n, law.creep.branches.size());
  return 1 + int(n);
}

std::size_t most_links_of(const QuasistaticVolume& volume)
{
  return volume.assembly.bonds.size() +
         near_per_particle * std::size_t(volume.bodies.n_particles());
}

} // namespace

std::size_t QuasistaticPoints::numbers_of_state() const
{
  std::size_t n = 0;
  for (const Volume& volume : volumes_)
    n = std::max(n, 24 + 9 * volume->bodies.radius.size() +
                        most_links_of(*volume) *
                            (numbers_per_link + 6 * std::size_t(parts_of(*volume))));
  return n;
}

std::size_t QuasistaticPoints::numbers_per_point() const
{
  return n_scalars + 6 + record_.numbers_per_point() +
         std::max(law_ ? law_->numbers_per_point() : 0, numbers_of_state());
}

void QuasistaticPoints::store(std::size_t point, std::span<double> numbers) const
{
  assert(numbers.size() >= numbers_per_point());
  std::ranges::fill(numbers, 0);
  const QuasistaticVolumeState* state = followed(point);
  const std::size_t n_links = state ? state->links.link.size() : 0;
  if (state && n_links > most_links_of(volume(point)))
    throw std::length_error("a volume has more near pairs than can be stored");
  Writer to(numbers);
  to.number(state ? 1 : 0);
  to.number(since_[point]);
  to.number(double(n_links));
  to.number(pace_);
  to.matrix(stress_[point]);
  std::size_t place = n_scalars + 6;
  record_.store(point, numbers.subspan(place, record_.numbers_per_point()));
  place += record_.numbers_per_point();
  if (Writer rest(numbers.subspan(place)); state)
    write_state(rest, *state);
  else
    law_->store(point, numbers.subspan(place));
}

void QuasistaticPoints::restore(std::size_t point, std::span<const double> numbers)
{
  assert(numbers.size() >= numbers_per_point());
  Reader from(numbers);
  const bool is_followed = from.number() != 0;
  since_[point] = from.number();
  const auto n_links = std::size_t(from.number());
  pace_ = from.number();
  from.matrix(stress_[point]);
  std::size_t place = n_scalars + 6;
  record_.restore(point, numbers.subspan(place, record_.numbers_per_point()));
  place += record_.numbers_per_point();
  state_[point].reset();
  if (!is_followed)
    return law_->restore(point, numbers.subspan(place));
  Reader rest(numbers.subspan(place));
  state_[point] = std::make_shared<const QuasistaticVolumeState>(
      read_state(rest, volume(point), parts_of(volume(point)), n_links));
  if (law_)
    law_->leave(point);
}

} // namespace coupling
