#include "gui/scene3d/world_actors.h"

#include <vtkActor.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include <algorithm>
#include <cmath>

#include "gui/scene3d/vtk_convert.h"
#include "mapping/world/kinematics.h"
#include "mapping/world/mesh_files.h"

namespace loci::gui {
namespace {

/// An edge is before its own faces by the slope of these and by nothing more: the fixed share of the depth
/// range that VTK adds is centimetres far from the eye, and edges within furniture would shine through.
void put_edges_before_faces(vtkPolyDataMapper& mapper) {
  double factor = 0, units = 0;
  vtkMapper::GetResolveCoincidentTopologyPolygonOffsetParameters(factor, units);
  mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters(0, -units);
  vtkMapper::GetResolveCoincidentTopologyLineOffsetParameters(factor, units);
  mapper.SetRelativeCoincidentTopologyLineOffsetParameters(-factor, -units);
}

vtkSmartPointer<vtkActor> actor_of(vtkPolyData* data) {
  vtkNew<vtkPolyDataMapper> mapper;
  mapper->SetInputData(data);
  mapper->SetStatic(1);  // nothing upstream to be asked for news at every frame
  put_edges_before_faces(*mapper);
  auto actor = vtkSmartPointer<vtkActor>::New();
  actor->SetMapper(mapper);
  // What one can see through is blended as it is drawn, last: VTK's pass for it costs more than all else
  // under software rendering.
  actor->ForceOpaqueOn();
  return actor;
}

std::vector<MeshPart> parts_of(const mapping::Link& link, const mapping::MeshSearch& search,
                               const SceneColors& colors, Warnings& warnings) {
  const mapping::Rgba plain(static_cast<float>(colors.world[0]), static_cast<float>(colors.world[1]),
                            static_cast<float>(colors.world[2]), 1);
  std::vector<MeshPart> parts;
  Warnings ignored;
  for (const mapping::Visual& visual : link.visuals) {
    MeshPart part;
    // A memory keeps the map without its photos; the panels behind have their colours.
    const bool photo = visual.name == mapping::kPhotoVisual;
    part.mesh = triangulate(visual.geometry, search, photo ? ignored : warnings);
    part.target_from_mesh = visual.link_from_visual;
    part.color = plain;
    if (visual.material && visual.material->color) {
      part.color = *visual.material->color;
      part.mesh.colors.clear();  // As in RViz, a material of the URDF wins over the mesh's own.
    }
    parts.push_back(std::move(part));
  }
  return parts;
}

Eigen::AlignedBox3d box_of(const std::vector<MeshPart>& parts) {
  Eigen::AlignedBox3d box;
  for (const MeshPart& part : parts)
    for (const auto& vertex : part.mesh.vertices) box.extend(part.target_from_mesh * vertex.cast<double>());
  return box;
}

Eigen::AlignedBox3d moved(const Eigen::AlignedBox3d& box, const Isometry3d& pose) {
  Eigen::AlignedBox3d result;
  for (int corner = 0; corner < 8; ++corner)
    result.extend(pose * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  return result;
}

/// Whether any of a box may be within all planes.
bool touches(const Eigen::AlignedBox3d& box, const std::vector<Eigen::Vector4d>& planes) {
  return std::all_of(planes.begin(), planes.end(), [&](const Eigen::Vector4d& plane) {
    const Vector3d normal = plane.head<3>();
    const Vector3d innermost = (normal.array() > 0).select(box.max(), box.min());
    return normal.dot(innermost) + plane.w() >= 0;
  });
}

bool is_shell(const std::string& link) {
  return link.starts_with("wall") || link.starts_with("ceiling");
}

}  // namespace

void WorldActors::clear() {
  for (LinkActors& link : links_) {
    renderer_->RemoveActor(link.surface);
    renderer_->RemoveActor(link.edges);
  }
  links_.clear();
  world_ = {};
  take_boxes();
}

void WorldActors::add_outline(const std::string& name, const std::vector<Vector2d>& outline, double height,
                              const SceneColors& colors) {
  if (outline.size() < 3) return;
  LinkActors actors;
  actors.name = name;
  for (const Vector2d& p : outline) actors.box.extend(Vector3d(p.x(), p.y(), height));
  actors.surface = actor_of(area_of(outline, height));
  actors.edges = actor_of(loop_of(outline, height));
  actors.edges->PickableOff();
  renderer_->AddActor(actors.surface);
  renderer_->AddActor(actors.edges);
  cut(actors);
  links_.push_back(std::move(actors));
  take_boxes();
  set_colors(colors);
  set_color(*links_.back().surface->GetProperty(), colors.accent);
  links_.back().surface->GetProperty()->SetOpacity(0.10);
  set_visible(visible_);
}

PreparedWorld prepare_world(const mapping::World& world, const mapping::MeshSearch& search,
                            const SceneColors& colors) {
  PreparedWorld prepared;
  Warnings warnings;
  for (const mapping::Link& link : world.links) {
    const auto parts = parts_of(link, search, colors, warnings);
    const bool see_through =
        std::any_of(parts.begin(), parts.end(), [](const MeshPart& part) { return part.color[3] < 1; });
    prepared.links.push_back(
        {link.name, surface_of(parts), sharp_edges_of(parts), box_of(parts), see_through});
  }
  prepared.warnings = warnings.texts();
  return prepared;
}

void WorldActors::set(const mapping::World& world, const PreparedWorld& prepared, const SceneColors& colors) {
  clear();
  world_ = world;
  std::vector<vtkActor*> see_through;
  for (const PreparedWorld::Part& part : prepared.links) {
    LinkActors actors;
    actors.name = part.link;
    actors.box = part.box;
    actors.shell = is_shell(part.link);
    actors.surface = actor_of(part.surface);
    actors.edges = actor_of(part.edges);
    actors.edges->PickableOff();
    if (part.see_through)
      see_through.push_back(actors.surface);
    else
      renderer_->AddActor(actors.surface);
    renderer_->AddActor(actors.edges);
    cut(actors);
    links_.push_back(std::move(actors));
  }
  for (vtkActor* actor : see_through) renderer_->AddActor(actor);
  set_colors(colors);
  set_joints({});
  set_visible(visible_);
}

void WorldActors::set_joints(const JointState& state) {
  if (world_.links.empty()) return;
  const auto poses = root_from_links(world_, joints_of_world(world_, state));
  for (size_t i = 0; i < poses.size(); ++i) {
    links_[i].map_from_link = poses[i];
    const auto matrix = matrix_of(poses[i]);
    links_[i].surface->SetUserMatrix(matrix);
    links_[i].edges->SetUserMatrix(matrix);
  }
  take_boxes();
}

void WorldActors::set_colors(const SceneColors& colors) {
  for (LinkActors& link : links_) {
    link.surface->GetProperty()->SetAmbient(0.42);
    link.surface->GetProperty()->SetDiffuse(0.64);
    link.surface->GetProperty()->SetSpecular(0);
    set_color(*link.edges->GetProperty(), colors.edges);
    link.edges->GetProperty()->SetLighting(false);
    link.edges->GetProperty()->SetLineWidth(static_cast<float>(colors.pixels));
  }
}

void WorldActors::set_visible(bool visible) {
  visible_ = visible;
  for (LinkActors& link : links_) {
    link.surface->SetVisibility(visible);
    link.edges->SetVisibility(visible);
  }
}

void WorldActors::select(const std::string& selected, const SceneColors& colors) {
  for (LinkActors& link : links_) {
    const bool on = !selected.empty() && link.name == selected;
    vtkProperty* edges = link.edges->GetProperty();
    set_color(*edges, on ? colors.accent : colors.edges);
    edges->SetLineWidth(static_cast<float>((on ? 3 : 1) * colors.pixels));
  }
}

void WorldActors::set_section(vtkPlane* plane) {
  section_ = plane;
  for (const LinkActors& link : links_) cut(link);
}

void WorldActors::cut(const LinkActors& link) const {
  for (vtkActor* actor : {link.surface.Get(), link.edges.Get()}) {
    actor->GetMapper()->RemoveAllClippingPlanes();
    if (section_ != nullptr) actor->GetMapper()->AddClippingPlane(section_);
  }
}

void WorldActors::take_boxes() {
  all_ = {};
  for (LinkActors& link : links_) {
    link.map_box = link.box.isEmpty() ? link.box : moved(link.box, link.map_from_link);
    if (!link.box.isEmpty()) all_.extend(link.map_box);
  }
}

bool WorldActors::hides_the_room(const LinkActors& link, const Vector3d& eye) const {
  if (!link.shell) return false;
  Eigen::Index thin = 0;
  link.box.sizes().minCoeff(&thin);
  const Vector3d normal = link.map_from_link.linear().col(thin);
  const Vector3d centre = link.map_from_link * link.box.center();
  return normal.dot(eye - centre) * normal.dot(all_.center() - centre) < 0;
}

void WorldActors::arrange(const Vector3d& eye, const std::vector<Eigen::Vector4d>& planes) {
  if (!visible_) return;
  for (LinkActors& link : links_) {
    if (link.box.isEmpty()) continue;
    const bool shown = touches(link.map_box, planes) && !hides_the_room(link, eye);
    link.surface->SetVisibility(shown);
    link.edges->SetVisibility(shown);
  }
}

const std::string* WorldActors::link_of(const vtkActor* actor) const {
  for (const LinkActors& link : links_)
    if (link.surface.Get() == actor) return &link.name;
  return nullptr;
}

std::optional<Eigen::AlignedBox3d> WorldActors::bounds() const {
  return all_.isEmpty() ? std::nullopt : std::optional(all_);
}

std::optional<Eigen::AlignedBox3d> WorldActors::bounds_of(const std::string& name) const {
  for (const LinkActors& link : links_)
    if (link.name == name && !link.box.isEmpty()) return link.map_box;
  return std::nullopt;
}

std::vector<vtkActor*> WorldActors::pickable() const {
  std::vector<vtkActor*> actors;
  for (const LinkActors& link : links_)
    if (link.surface->GetVisibility() != 0) actors.push_back(link.surface);
  return actors;
}

}  // namespace loci::gui
