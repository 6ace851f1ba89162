#pragma once

#include <map>
#include <vector>

#include "mapping/base/math/random.h"

namespace loci::apps::system_evaluation {

/// How often each number occurs.
using Histogram = std::map<int, int>;

/// Tables 8.1 to 8.3: how many of the 103 scenes had so many flat, three-dimensional and all objects. (Table
/// 8.3 prints 46 scenes with nine objects where its own share, 3.9 %, and the sums need 4.)
const Histogram& published_flat();
const Histogram& published_solid();
const Histogram& published_total();

struct SceneCount {
  int flat = 0;
  int solid = 0;
};

/// Numbers of objects for scenes: 103 scenes have exactly the three histograms; fewer are the first of them,
/// more begin again. In random order.
std::vector<SceneCount> scene_counts(int scenes, Random random);

}  // namespace loci::apps::system_evaluation
