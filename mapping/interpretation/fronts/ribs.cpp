#include "mapping/interpretation/fronts/ribs.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mapping/interpretation/fronts/parameters.h"

namespace loci::mapping {

std::vector<Fixture> remove_ribs(std::vector<FaceFixture>& fixtures) {
  std::vector<size_t> upright;
  for (size_t i = 0; i < fixtures.size(); ++i)
    if (fixtures[i].fixture.kind == Fixture::Kind::handle &&
        fixtures[i].box.height() > fixtures[i].box.width())
      upright.push_back(i);
  std::stable_sort(upright.begin(), upright.end(),
                   [&](size_t a, size_t b) { return fixtures[a].u < fixtures[b].u; });
  const auto follows = [&](size_t before, size_t after) {
    const FaceFixture& a = fixtures[before];
    const FaceFixture& b = fixtures[after];
    const double shared = std::min(a.box.v1, b.box.v1) - std::max(a.box.v0, b.box.v0);
    return b.u - a.u < kFixtures.max_rib_spacing_m &&
           shared > kFixtures.rib_overlap * std::min(a.box.height(), b.box.height());
  };
  std::set<size_t> in_rows;
  for (size_t first = 0, last = 0; first < upright.size(); first = last) {
    for (last = first + 1; last < upright.size() && follows(upright[last - 1], upright[last]);) ++last;
    if (last - first >= kFixtures.min_ribs)
      in_rows.insert(upright.begin() + static_cast<std::ptrdiff_t>(first),
                     upright.begin() + static_cast<std::ptrdiff_t>(last));
  }
  std::vector<Fixture> ribs;
  if (in_rows.empty()) return ribs;
  FaceRect row = fixtures[*in_rows.begin()].box;
  for (const size_t i : in_rows) {
    const FaceRect& box = fixtures[i].box;
    row = {std::min(row.u0, box.u0), std::max(row.u1, box.u1), std::min(row.v0, box.v0),
           std::max(row.v1, box.v1)};
    ribs.push_back(fixtures[i].fixture);
  }
  row = row.grown(kFixtures.max_rib_spacing_m);
  std::erase_if(fixtures, [&](const FaceFixture& one) { return row.contains(one.u, one.v); });
  return ribs;
}

bool is_of_ribs(const Front& front, const std::vector<Fixture>& ribs) {
  return front.fixture && std::any_of(ribs.begin(), ribs.end(), [&](const Fixture& rib) {
           const Vector3d d = front.fixture->centre - rib.centre;
           return d.head<2>().norm() < kFixtures.max_rib_spacing_m &&
                  std::abs(d.z()) < (rib.length + kFixtures.max_rib_spacing_m) / 2;
         });
}

}  // namespace loci::mapping
