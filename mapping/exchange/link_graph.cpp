#include "mapping/exchange/link_graph.h"

#include <fmt/format.h>

#include <algorithm>

#include "mapping/base/text/html.h"

namespace loci::mapping {
namespace {

constexpr double kRow = 30;      // px between leaves
constexpr double kBox = 22;      // px, height of a box
constexpr double kLetter = 7.2;  // px, width of a letter of the font below
constexpr double kGap = 36;      // px between a box and the next
constexpr double kPageMargin = 20;

/// A link or a joint that moves.
struct Node {
  std::string name, note;
  const char* color = "#f4f4f2";
  bool joint = false;
  size_t depth = 0;
  double y = 0;
  std::vector<size_t> below;

  double width() const { return kLetter * static_cast<double>(std::max(name.size(), note.size())) + 16; }
};

const char* node_color(const std::string& class_name) {
  if (class_name == "front" || class_name == "drawer" || class_name == "door" || class_name == "flap")
    return "#cfe6f5";
  if (class_name == "handle" || class_name == "knob") return "#bfe3b4";
  if (class_name == "drawer_bottom") return "#f3b7ae";
  if (class_name == "counter" || class_name == "table" || class_name == "shelf" || class_name == "island")
    return "#9fc0e8";
  return "#f4f4f2";
}

class Graph {
 public:
  Graph(const World& world, const SemanticMap& semantics, const std::string& root)
      : world_(world), semantics_(semantics) {
    add_link(root, 0);
    place(0);
  }

  std::string svg() const {
    const double height = 2 * kPageMargin + kRow * static_cast<double>(rows_);
    double width = 2 * kPageMargin;
    for (const Node& node : nodes_) width = std::max(width, left_of(node) + node.width() + kPageMargin);
    std::string text = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
        "viewBox=\"0 0 {0:.0f} {1:.0f}\" font-family=\"monospace\" font-size=\"12\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        width, height);
    for (const Node& node : nodes_)
      for (const size_t below : node.below) text += edge(node, nodes_[below]);
    for (const Node& node : nodes_) text += shape(node);
    return text + "</svg>\n";
  }

 private:
  size_t add(Node node) {
    if (widths_.size() <= node.depth) widths_.resize(node.depth + 1, 0);
    widths_[node.depth] = std::max(widths_[node.depth], node.width());
    nodes_.push_back(std::move(node));
    return nodes_.size() - 1;
  }

  size_t add_link(const std::string& link, size_t depth) {
    const auto entry = semantics_.links.find(link);
    Node node;
    node.name = link;
    node.depth = depth;
    if (entry != semantics_.links.end()) node.color = node_color(entry->second.class_name);
    const size_t index = add(std::move(node));
    for (const Joint& joint : world_.joints) {
      if (joint.parent != link) continue;
      const bool moves = joint.type != JointType::fixed;
      const size_t below = moves ? add_joint(joint, depth + 1) : add_link(joint.child, depth + 1);
      nodes_[index].below.push_back(below);
    }
    return index;
  }

  size_t add_joint(const Joint& joint, size_t depth) {
    Node node;
    node.name = joint.name;
    node.note = joint_type_name(joint.type);
    node.color = "#f9c784";
    node.joint = true;
    node.depth = depth;
    const size_t index = add(std::move(node));
    const size_t below = add_link(joint.child, depth + 1);
    nodes_[index].below = {below};
    return index;
  }

  /// Leaves in rows, what is above in the middle of them.
  void place(size_t index) {
    Node& node = nodes_[index];
    for (const size_t below : node.below) place(below);
    node.y = node.below.empty() ? kPageMargin + kRow * (static_cast<double>(rows_++) + 0.5)
                                : (nodes_[node.below.front()].y + nodes_[node.below.back()].y) / 2;
  }

  double left_of(const Node& node) const {
    double left = kPageMargin;
    for (size_t depth = 0; depth < node.depth; ++depth) left += widths_[depth] + kGap;
    return left;
  }

  std::string edge(const Node& from, const Node& to) const {
    const double x1 = left_of(from) + from.width();
    const double x2 = left_of(to);
    const double middle = x2 - kGap / 2;
    return fmt::format(
        "<path d=\"M {0:.1f} {1:.1f} H {2:.1f} V {3:.1f} H {4:.1f}\" fill=\"none\" stroke=\"#888\"/>\n", x1,
        from.y, middle, to.y, x2);
  }

  std::string shape(const Node& node) const {
    const double left = left_of(node);
    const double width = node.width();
    const std::string outline =
        node.joint
            ? fmt::format("<ellipse cx=\"{:.1f}\" cy=\"{:.1f}\" rx=\"{:.1f}\" ry=\"{:.1f}\"",
                          left + width / 2, node.y, width / 2, 0.65 * kBox)
            : fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" rx=\"3\"", left,
                          node.y - kBox / 2, width, kBox);
    return outline +
           fmt::format(" fill=\"{}\" stroke=\"#555\"><title>{}</title></{}>\n", node.color,
                       html_escape(node.note), node.joint ? "ellipse" : "rect") +
           fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", left + width / 2,
                       node.y + 4, html_escape(node.name));
  }

  const World& world_;
  const SemanticMap& semantics_;
  std::vector<Node> nodes_;
  std::vector<double> widths_;  ///< of the widest node, by depth
  size_t rows_ = 0;
};

}  // namespace

std::string link_graph_svg(const World& world, const SemanticMap& semantics, const std::string& root) {
  const std::string& start = root.empty() ? world.root : root;
  if (!start.empty()) static_cast<void>(world.link_index(start));  // complains with the closest name
  return Graph(world, semantics, start).svg();
}

}  // namespace loci::mapping
