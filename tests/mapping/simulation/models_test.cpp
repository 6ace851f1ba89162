#include "mapping/simulation/models.h"

#include <gtest/gtest.h>

namespace loci::mapping {
namespace {

/// Volume by the divergence theorem: positive when triangles face outwards.
double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vector3d a = mesh.vertices[t[0]].cast<double>();
    const Vector3d b = mesh.vertices[t[1]].cast<double>();
    const Vector3d c = mesh.vertices[t[2]].cast<double>();
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

TEST(Models, StandOnTheirBottomFaceOutwardsAndHaveAColourPerTriangle) {
  for (const std::string& name : object_models()) {
    ObjectSpec spec;
    spec.model = name;
    const ObjectModel model = build_object(spec);
    EXPECT_NEAR(model.low.z(), 0, 1e-7) << name;
    EXPECT_LE(model.top, model.high.z()) << name;
    EXPECT_LT((model.high - model.low).maxCoeff(), 0.4) << name;
    EXPECT_EQ(model.mesh.colors.size(), model.mesh.triangles.size()) << name;
    EXPECT_GT(volume(model.mesh), 0) << name;
    EXPECT_LE(volume(model.mesh), (model.high - model.low).prod() + 1e-8) << name;
  }
}

TEST(Models, BoxHasItsVolume) {
  ObjectSpec spec;
  spec.model = "box";
  spec.size = Vector3d(0.1, 0.2, 0.3);
  EXPECT_NEAR(volume(build_object(spec).mesh), 0.006, 1e-8);
}

TEST(Models, SizeIsTheWholeExtent) {
  ObjectSpec spec;
  spec.model = "mug";
  spec.size = Vector3d(0.12, 0.09, 0.11);
  const ObjectModel model = build_object(spec);
  EXPECT_TRUE((model.high - model.low).isApprox(*spec.size, 1e-6));
}

TEST(Models, PatternsShowBothColours) {
  for (const std::string& pattern : object_patterns()) {
    ObjectSpec spec;
    spec.model = "can";
    spec.pattern = pattern;
    spec.color = Rgba(1, 0, 0, 1);
    spec.accent = Rgba(0, 1, 0, 1);
    int accents = 0;
    for (const Rgba& color : build_object(spec).mesh.colors) accents += color == *spec.accent ? 1 : 0;
    EXPECT_GT(accents, 100) << pattern;
  }
}

}  // namespace
}  // namespace loci::mapping
