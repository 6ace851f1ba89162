#include "perception/pipeline/pipeline.h"

#include <gmock/gmock.h>

#include "perception/types/scene_cas.h"

namespace loci::perception {
namespace {

using ::testing::HasSubstr;

class CountingReader : public Reader {
 public:
  AnnotatorDescriptor descriptor() const override {
    return {"RecordingReader", "Empty scenes.", {}, {"Scene", "view:depth"}};
  }
  void declare(OptionTable& table) override { table.integer("every", every_, "frames", "Step.", 1, 100); }
  void start(Context&) override {}
  size_t count() const override { return 3; }
  size_t position() const override { return position_; }
  FrameId upcoming() const override { return {static_cast<int64_t>(position_ + 10), 0}; }
  void read_next(cas::Cas& cas, Context&) override {
    types::SceneCas(cas).create_scene().frame_index.set(upcoming().index);
    ++position_;
  }
  void skip(size_t frames) override { position_ += frames; }

 private:
  size_t position_ = 0;
  int every_ = 1;
};

class Finder : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override {
    return {"Finder", "Finds a cluster.", {"view:depth"}, {"Cluster"}};
  }
  void declare(OptionTable& table) override {
    table.number("tolerance_m", tolerance_m_, "m", "Gap.", 0.001, 1);
  }
  void process(cas::Cas& cas, Context&) override {
    types::SceneCas(cas).add_cluster(types::Cluster::create(cas));
  }

 private:
  double tolerance_m_ = 0.02;
};

class Describer : public Annotator {
 public:
  AnnotatorDescriptor descriptor() const override {
    return {"Describer", "Describes clusters.", {"Cluster"}, {"ColorAnnotation"}};
  }
  void process(cas::Cas& cas, Context&) override {
    if (types::SceneCas(cas).scene().frame_index.get() == 12) throw Error("the lamp is out");
  }
};

/// Counts how often it was finished; it fails then.
class Finisher : public Annotator {
 public:
  explicit Finisher(int& finished) : finished_(finished) {}
  AnnotatorDescriptor descriptor() const override { return {"Finisher", "Counts.", {"Cluster"}, {}}; }
  void process(cas::Cas&, Context&) override {}
  void finish(Context&) override {
    ++finished_;
    throw Error("the disk is full");
  }

 private:
  int& finished_;
};

AnnotatorRegistry registry() {
  AnnotatorRegistry made;
  made.add_reader<CountingReader>();
  made.add<Finder>();
  made.add<Describer>();
  return made;
}

std::string refusal(const std::string& yaml) {
  try {
    Pipeline::parse(yaml, "p.yaml", registry());
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Pipeline, NamesTheNearestAnnotatorAndTheLine) {
  const std::string text = refusal("flow:\n  - Findr\n");
  EXPECT_THAT(text, HasSubstr("p.yaml:2"));
  EXPECT_THAT(text, HasSubstr("did you mean 'Finder'?"));
}

TEST(Pipeline, NamesTheNearestOption) {
  EXPECT_THAT(refusal("flow:\n  - Finder: {tolerance: 0.02}\n"), HasSubstr("did you mean 'tolerance_m'?"));
  EXPECT_THAT(refusal("flow:\n  - Finder: {tolerance_m: 7}\n"), HasSubstr("allowed is 0.001 to 1"));
  EXPECT_THAT(refusal("reader: {RecordingReader: {evry: 2}}\nflow: [Finder]\n"), HasSubstr("'every'"));
  EXPECT_THAT(refusal("flaw: [Finder]\n"), HasSubstr("p.yaml"));
}

TEST(Pipeline, RefusesWhatNobodyMakesAndNamesWhoCould) {
  const std::string text = refusal("flow: [Describer]\n");
  EXPECT_THAT(text, HasSubstr("Describer needs Cluster"));
  EXPECT_THAT(text, HasSubstr("put Finder before it"));
  EXPECT_THAT(refusal("flow: [Describer, Finder]\n"), HasSubstr("Describer needs Cluster"));
  EXPECT_EQ(refusal("flow: [Finder, Describer]\n"), "accepted");
}

TEST(Pipeline, NeedsAnnotators) {
  EXPECT_THAT(refusal(""), HasSubstr("no annotators"));
  EXPECT_THAT(refusal("flow: Finder\n"), HasSubstr("a list was expected"));
}

TEST(Pipeline, ReportsAnErrorWithAnnotatorAndFrame) {
  Pipeline pipeline = Pipeline::parse("flow: [Finder, Describer]\n", "p.yaml", registry());
  Resources resources;
  Warnings warnings;
  Context context{resources, warnings, 1, {}};
  NoProgress progress;
  int done = 0;
  try {
    pipeline.run(context, types::type_system(), progress, [&](cas::Cas&) { ++done; });
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "Describer failed at frame 12: the lamp is out");
  }
  EXPECT_EQ(done, 2);
}

TEST(Pipeline, FinishesEverybodyAlsoAfterAFailure) {
  int finished = 0;
  AnnotatorRegistry made = registry();
  made.add("Finisher", [&] { return std::make_unique<Finisher>(finished); });
  Pipeline pipeline = Pipeline::parse("flow: [Finder, Finisher, Describer]\n", "p.yaml", made);
  Resources resources;
  Warnings warnings;
  Context context{resources, warnings, 1, {}};
  NoProgress progress;
  try {
    pipeline.run(context, types::type_system(), progress);
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "Describer failed at frame 12: the lamp is out");
  }
  EXPECT_EQ(finished, 1);
  EXPECT_EQ(warnings.texts(), std::vector<std::string>{"Finisher cannot finish: the disk is full"});
}

TEST(Pipeline, LogsTheTimeOfEachAnnotatorInTheScene) {
  Pipeline pipeline = Pipeline::parse("flow: [Finder]\n", "p.yaml", registry());
  Resources resources;
  Warnings warnings;
  Context context{resources, warnings, 1, {}};
  NoProgress progress;
  const PipelineResult result = pipeline.run(context, types::type_system(), progress, [](cas::Cas& cas) {
    const types::Log log = types::SceneCas(cas).scene().log.get();
    ASSERT_EQ(log.entries.size(), 1U);
    EXPECT_EQ(log.entries[0].annotator.get(), "Finder");
    EXPECT_TRUE(log.entries[0].milliseconds.is_set());
  });
  EXPECT_EQ(result.frames, 3U);
  EXPECT_EQ(result.seconds.size(), 2U);
  EXPECT_EQ(context.configuration["flow"][0]["Finder"]["tolerance_m"], 0.02);
}

TEST(Pipeline, SkipsFramesBetweenStartAndRun) {
  Pipeline pipeline = Pipeline::parse("flow: [Finder]\n", "p.yaml", registry());
  Resources resources;
  Warnings warnings;
  Context context{resources, warnings, 1, {}};
  NoProgress progress;
  pipeline.start(context);
  pipeline.reader().skip(2);
  EXPECT_EQ(pipeline.run(context, types::type_system(), progress).frames, 1U);
}

TEST(Resources, SayWhatIsMissing) {
  const Resources resources;
  EXPECT_EQ(resources.find<int>(), nullptr);
  EXPECT_THROW(resources.get<int>("number", "give one"), Error);
}

}  // namespace
}  // namespace loci::perception
