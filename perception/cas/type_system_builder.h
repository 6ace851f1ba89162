#pragma once

#include <map>
#include <set>

#include "perception/cas/type_system.h"

namespace tinyxml2 {
class XMLElement;
}

namespace loci::perception::cas {

/// Collects declarations from built-in types, texts and files, merges them, and makes a TypeSystem. Names are
/// resolved at the end, so the order of files does not matter.
class TypeSystemBuilder {
 public:
  TypeSystemBuilder(const std::vector<loci::perception::cas::TypeSource>& sources,
                    std::vector<std::filesystem::path> path_dirs);

  void add_file(const std::filesystem::path& path, const FileLocation& from = {});
  void add_source(const loci::perception::cas::TypeSource& source);
  std::shared_ptr<const loci::perception::cas::TypeSystem> finish();

 private:
  struct FeatureDeclaration {
    std::string name, description, range, element;
    std::optional<bool> multiple_references;
    FileLocation place;
  };
  struct TypeDeclaration {
    std::string name, description, supertype;
    std::vector<FeatureDeclaration> features;
    std::vector<std::string> allowed_values;
    bool has_allowed_values = false;
    bool builtin = false;
    FileLocation place;
    int state = 0;  ///< 0 new, 1 being built, 2 built
    loci::perception::cas::detail::TypeData* data = nullptr;
  };

  void add_builtin_types();
  void add_text(const std::string& text, const std::string& file, const std::filesystem::path& folder);
  void add_import(const tinyxml2::XMLElement& element, const std::string& file,
                  const std::filesystem::path& folder);
  TypeDeclaration read_type(const tinyxml2::XMLElement& element, const std::string& file) const;
  FeatureDeclaration read_feature(const tinyxml2::XMLElement& element, const std::string& file) const;
  void declare(TypeDeclaration declaration);
  void declare_builtin(const std::string& name, const std::string& supertype,
                       std::vector<std::pair<std::string, std::string>> features = {});
  static void merge(TypeDeclaration& known, const TypeDeclaration& again);
  static void merge_feature(const std::string& type, FeatureDeclaration& known,
                            const FeatureDeclaration& again);

  TypeDeclaration& resolve(const std::string& name, const FileLocation& place, const std::string& what);
  void build_hierarchy(loci::perception::cas::TypeSystem& system);
  void build_type(loci::perception::cas::TypeSystem& system, TypeDeclaration& declaration, int depth = 0);
  void build_order(loci::perception::cas::TypeSystem& system);
  void build_features(loci::perception::cas::TypeSystem& system);
  void add_feature(loci::perception::cas::detail::TypeData& type, const FeatureDeclaration& declaration);
  static void index_types(loci::perception::cas::TypeSystem& system);

  std::map<std::string, std::string> sources_;
  std::vector<std::filesystem::path> path_dirs_;
  std::set<std::string> read_;
  std::map<std::string, TypeDeclaration> declarations_;
};

}  // namespace loci::perception::cas
