#pragma once
#include "dem/random.h"
#include "dem/types.h"
#include "tests/apps/command.h"

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <vector>

/// Files of small networks for scenes.
namespace networks {

/// A scene for particles.csv and bonds.csv, without what takes time and is tested elsewhere.
inline const std::string scene = R"(set Title = Small network
subsection Specimen
  set Source = file
  set File = particles.csv
  set Bond file = bonds.csv
  set Diameter = 16 mm
end
subsection Output
  set Plots = false
  set ParaView = false
end
)";

/// Spheres near the sites of a cubic lattice, each bonded to those around it; strengths from 2 to
/// 20 N. Under 1000 kPa bonds break one after the other for three minutes.
struct Lattice {
  std::vector<dem::Vec3> centre; ///< [mm]
  std::vector<double> radius;    ///< [mm]
  std::vector<std::string> held;

  Lattice(int n_side, int n_high, std::uint64_t seed)
  {
    const auto draw = [&](std::uint32_t k) {
      return dem::uniform(seed, dem::RandomStream::packing, centre.size(), k);
    };
    for (int z = 0; z < n_high; ++z)
      for (int y = 0; y < n_side; ++y)
        for (int x = 0; x < n_side; ++x) {
          const dem::Vec3 jitter(draw(0) - 0.5, draw(1) - 0.5, draw(2) - 0.5);
          radius.push_back(1.44 + 0.24 * draw(3));
          centre.push_back(4 * dem::Vec3(x, y, z) + 0.64 * jitter);
          held.push_back(z == 0 ? "bottom" : z + 1 == n_high ? "top" : "free");
        }
  }

  std::string particles() const
  {
    std::string text = "x_mm,y_mm,z_mm,r_mm,held\n";
    for (std::size_t i = 0; i < centre.size(); ++i)
      text += fmt::format("{},{},{},{},{}\n", centre[i].x(), centre[i].y(), centre[i].z(),
                          radius[i], held[i]);
    return text;
  }

  std::string bonds(std::uint64_t seed) const
  {
    std::string text = "a,b,normal_strength_N,shear_strength_N\n";
    std::uint64_t n = 0;
    for (std::size_t i = 0; i < centre.size(); ++i)
      for (std::size_t j = i + 1; j < centre.size(); ++j)
        if ((centre[i] - centre[j]).norm() < 5.8 && (held[i] != held[j] || held[i] == "free")) {
          const auto strength = [&](std::uint32_t k) {
            return 2 + 18 * dem::uniform(seed, dem::RandomStream::strength, n, k);
          };
          text += fmt::format("{},{},{},{}\n", i, j, strength(0), strength(1));
          ++n;
        }
    return text;
  }
};

/// Writes net.scene, particles.csv and bonds.csv: 96 spheres, about 400 bonds.
inline void write_lattice(const command::Folder& folder)
{
  const Lattice lattice(4, 6, 1);
  folder.write("particles.csv", lattice.particles());
  folder.write("bonds.csv", lattice.bonds(1));
  folder.write("net.scene", scene);
}

/// Writes the files of two spheres one above the other, bonded, between the platens.
inline void write_pair(const command::Folder& folder)
{
  folder.write("particles.csv", "x_mm,y_mm,z_mm,r_mm,held\n0,0,2,2,bottom\n0,0,6,2,top\n");
  folder.write("bonds.csv", "a,b\n0,1\n");
  folder.write("net.scene", scene);
}

} // namespace networks
