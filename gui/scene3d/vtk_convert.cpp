#include "gui/scene3d/vtk_convert.h"

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkProperty.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>

namespace loci::gui {
namespace {

/// Beyond this many triangles a mesh is a scan or a free form: its edges say nothing and cost much.
constexpr size_t kMaxTrianglesForEdges = 20000;
constexpr float kSmoothCosine = 0.866F;

unsigned char byte_of(float value) {
  return static_cast<unsigned char>(std::lround(std::clamp(value, 0.0F, 1.0F) * 255));
}

using Grid = std::tuple<int64_t, int64_t, int64_t>;

/// Vertices are repeated per triangle in most files; equal to a tenth of a millimetre is equal.
Grid grid_of(const Eigen::Vector3f& p) {
  return {std::llround(p.x() * 1e4F), std::llround(p.y() * 1e4F), std::llround(p.z() * 1e4F)};
}

struct Edge {
  Eigen::Vector3f from, to;
  Eigen::Vector3f normal;
  int faces = 0;
  bool sharp = false;
};

void collect_edges(const mapping::TriangleMesh& mesh, std::map<std::pair<Grid, Grid>, Edge>& edges) {
  for (const auto& triangle : mesh.triangles) {
    const std::array<Eigen::Vector3f, 3> p = {mesh.vertices[triangle[0]], mesh.vertices[triangle[1]],
                                              mesh.vertices[triangle[2]]};
    const Eigen::Vector3f normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    for (size_t i = 0; i < 3; ++i) {
      Grid a = grid_of(p[i]);
      Grid b = grid_of(p[(i + 1) % 3]);
      if (b < a) std::swap(a, b);
      Edge& edge = edges[{a, b}];
      if (edge.faces > 0 && std::abs(edge.normal.dot(normal)) < kSmoothCosine) edge.sharp = true;
      if (edge.faces == 0) edge = {p[i], p[(i + 1) % 3], normal, 0, false};
      ++edge.faces;
    }
  }
}

vtkSmartPointer<vtkPoints> points_of(const std::vector<Vector2d>& outline, double height) {
  auto points = vtkSmartPointer<vtkPoints>::New();
  for (const Vector2d& p : outline) points->InsertNextPoint(p.x(), p.y(), height);
  return points;
}

vtkIdType insert_point(vtkPoints& points, const Eigen::Vector3f& p) {
  return points.InsertNextPoint(static_cast<double>(p.x()), static_cast<double>(p.y()),
                                static_cast<double>(p.z()));
}

}  // namespace

vtkSmartPointer<vtkPolyData> surface_of(const std::vector<MeshPart>& parts) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(4);
  for (const MeshPart& part : parts) {
    const Eigen::Isometry3f pose = part.target_from_mesh.cast<float>();
    const vtkIdType first = points->GetNumberOfPoints();
    for (const auto& vertex : part.mesh.vertices) insert_point(*points, pose * vertex);
    for (size_t i = 0; i < part.mesh.triangles.size(); ++i) {
      const auto& triangle = part.mesh.triangles[i];
      const std::array<vtkIdType, 3> ids = {first + triangle[0], first + triangle[1], first + triangle[2]};
      cells->InsertNextCell(3, ids.data());
      const mapping::Rgba& c = part.mesh.colors.empty() ? part.color : part.mesh.colors[i];
      const std::array<unsigned char, 4> rgba = {byte_of(c[0]), byte_of(c[1]), byte_of(c[2]), byte_of(c[3])};
      colors->InsertNextTypedTuple(rgba.data());
    }
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetPolys(cells);
  data->GetCellData()->SetScalars(colors);
  return data;
}

vtkSmartPointer<vtkPolyData> sharp_edges_of(const std::vector<MeshPart>& parts) {
  vtkNew<vtkPoints> points;
  vtkNew<vtkCellArray> lines;
  for (const MeshPart& part : parts) {
    if (part.mesh.triangles.size() > kMaxTrianglesForEdges) continue;
    std::map<std::pair<Grid, Grid>, Edge> edges;
    collect_edges(part.mesh, edges);
    const Eigen::Isometry3f pose = part.target_from_mesh.cast<float>();
    for (const auto& [key, edge] : edges) {
      if (!edge.sharp && edge.faces > 1) continue;
      const std::array<vtkIdType, 2> ids = {insert_point(*points, pose * edge.from),
                                            insert_point(*points, pose * edge.to)};
      lines->InsertNextCell(2, ids.data());
    }
  }
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points);
  data->SetLines(lines);
  return data;
}

vtkSmartPointer<vtkPolyData> area_of(const std::vector<Vector2d>& outline, double height) {
  std::vector<vtkIdType> ids(outline.size());
  std::iota(ids.begin(), ids.end(), 0);
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points_of(outline, height));
  data->SetPolys(cells);
  return data;
}

vtkSmartPointer<vtkPolyData> loop_of(const std::vector<Vector2d>& outline, double height) {
  std::vector<vtkIdType> ids(outline.size());
  std::iota(ids.begin(), ids.end(), 0);
  ids.push_back(0);
  vtkNew<vtkCellArray> cells;
  cells->InsertNextCell(static_cast<vtkIdType>(ids.size()), ids.data());
  auto data = vtkSmartPointer<vtkPolyData>::New();
  data->SetPoints(points_of(outline, height));
  data->SetLines(cells);
  return data;
}

void set_color(vtkProperty& property, const SceneColor& color) {
  property.SetColor(color[0], color[1], color[2]);
}

vtkSmartPointer<vtkMatrix4x4> matrix_of(const Isometry3d& pose) {
  auto matrix = vtkSmartPointer<vtkMatrix4x4>::New();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) matrix->SetElement(row, column, pose.matrix()(row, column));
  return matrix;
}

}  // namespace loci::gui
