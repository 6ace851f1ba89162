#include "memory/questions/replies/answer_fields.h"

#include <gmock/gmock.h>

#include <set>

#include "memory/questions/question.h"

namespace loci::memory::format {
namespace {

struct Shelf {
  std::string name = "shelf_1";
  std::optional<double> height = {};
  std::vector<SceneRef> views = {};
  std::vector<std::pair<std::string, size_t>> counts = {};
  Verdict free = Verdict::not_observed;
  TimeNs built = 0;
  std::optional<ObjectRef> on_it = {};
};

const Record<Shelf>& shelf_record() {
  static const auto record = Record<Shelf>("Shelf")
                                 .value("name", &Shelf::name)
                                 .value("height", &Shelf::height)
                                 .record("views", &Shelf::views, scene_record())
                                 .value("counts", &Shelf::counts)
                                 .value("free", &Shelf::free)
                                 .time("built", &Shelf::built)
                                 .with(&Shelf::on_it, object_record());
  return record;
}

TEST(AnswerFields, AreWrittenInTheirOrderAndLeftOutWhereTheyAreUnset) {
  Shelf shelf;
  EXPECT_EQ(
      shelf_record().json(shelf).dump(),
      R"({"name":"shelf_1","views":[],"counts":{},"free":"not_observed","built":"1970-01-01T00:00:00Z"})");
  shelf.height = 1.5;
  shelf.views = {{.scene = 3, .time = kSecond}};
  shelf.counts = {{"z", 1}, {"a", 2}};
  shelf.on_it = ObjectRef{.id = 4, .name = "object_4"};
  EXPECT_EQ(
      shelf_record().json(shelf).dump(),
      R"({"name":"shelf_1","height":1.5,"views":[{"scene":3,"time":"1970-01-01T00:00:01Z"}],)"
      R"("counts":{"z":1,"a":2},"free":"not_observed","built":"1970-01-01T00:00:00Z","object":"object_4"})");
}

TEST(AnswerFields, AreDeclaredByAJsonSchema) {
  const Json all = shelf_record().definitions();
  EXPECT_TRUE(all.contains("Scene")) << "what a field refers to is there, too";
  const Json& shelf = all.at("Shelf");
  EXPECT_EQ(shelf["required"], Json({"name", "views", "counts", "free", "built"}))
      << "nothing of a part that may be missing";
  const Json& fields = shelf["properties"];
  EXPECT_EQ(fields["height"], (Json{{"type", "number"}}));
  EXPECT_EQ(fields["views"]["items"], scene_record().reference());
  EXPECT_EQ(fields["counts"]["additionalProperties"]["type"], "integer");
  EXPECT_EQ(fields["free"]["enum"], Json({"yes", "no", "not_observed"}));
  EXPECT_EQ(fields["built"]["format"], "date-time");
  EXPECT_EQ(fields["object"]["type"], "string");
}

/// Names that a schema refers to.
void collect_references(const Json& schema, std::set<std::string>& names) {
  if (schema.is_object() && schema.contains("$ref")) names.insert(schema["$ref"].get<std::string>());
  if (schema.is_structured())
    for (const Json& part : schema) collect_references(part, names);
}

TEST(AnswerFields, OfEveryQuestionAreDeclared) {
  const Json declared = questions_json();
  std::set<std::string> names;
  collect_references(declared["$defs"], names);
  for (const Json& question : declared["questions"])
    names.insert("#/$defs/" + question["answer"].get<std::string>());
  EXPECT_GT(names.size(), questions().size());
  for (const std::string& name : names)
    EXPECT_TRUE(declared["$defs"].contains(name.substr(std::string("#/$defs/").size()))) << name;
}

}  // namespace
}  // namespace loci::memory::format
