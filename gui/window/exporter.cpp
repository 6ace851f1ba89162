#include "gui/window/exporter.h"

#include <QFileDialog>

#include "gui/core/background.h"
#include "gui/data/exports.h"
#include "gui/data/object_details.h"
#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "mapping/world/urdf.h"
#include "memory/report/memory_report.h"
#include "memory/store/store.h"

namespace loci::gui {
namespace {

/// What is believed of the selected object, or of what is at the selected place; all when nothing is
/// selected.
Belief selected_part(Belief belief, const SelectionModel& selection) {
  if (!selection.object() && selection.place().empty()) return belief;
  std::erase_if(belief.objects, [&, names = belief.names](const BelievedObject& object) {
    return selection.object() ? object.object != *selection.object()
                              : names->place(object.place) != selection.place();
  });
  return belief;
}

}  // namespace

Exporter::Exporter(Browser& browser, QWidget* window) : QObject(window), browser_(browser), window_(window) {}

void Exporter::write(const QString& name, const QString& filter,
                     const std::function<std::string(const std::string& path)>& content) {
  const QString path = QFileDialog::getSaveFileName(window_, "Export", name, filter);
  if (path.isEmpty()) return;
  in_background<bool>(
      this,
      [path = path.toStdString(), content] {
        write_file_atomically(path, content(path));
        return true;
      },
      [this, path](bool&) { Q_EMIT message("Saved " + path); },
      [this](const std::exception_ptr& error) { Q_EMIT browser_.failed(reason_of(error)); });
}

void Exporter::table() {
  write("believed.csv", "Tables (*.csv);;JSON (*.json)",
        [belief = selected_part(browser_.belief(), browser_.selection())](const std::string& path) {
          return path.ends_with(".json") ? believed_json(belief) : believed_csv(belief);
        });
}

void Exporter::object_images() {
  const auto object = browser_.selection().object();
  if (!object) return message("Select an object first");
  const QString folder = QFileDialog::getExistingDirectory(window_, "Folder for the images");
  if (folder.isEmpty()) return;
  in_background<size_t>(
      this,
      [memory = browser_.shared_data(), id = *object, time = browser_.selection().time(),
       path = std::filesystem::path(folder.toStdString())] {
        const std::vector<ObjectImage> images = memory->details(id, time).images;
        for (size_t i = 0; i < images.size(); ++i)
          mapping::write_image(path / (memory::object_name(id) + "_" + std::to_string(i + 1) + ".png"),
                               images[i].image);
        return images.size();
      },
      [this, folder](size_t& count) {
        Q_EMIT message(QString("Saved %1 images in %2").arg(count).arg(folder));
      },
      [this](const std::exception_ptr& error) { Q_EMIT browser_.failed(reason_of(error)); });
}

void Exporter::scene_image() {
  const auto content = browser_.moment().content;
  if (content == nullptr || content->color.empty()) return message("No image is stored for this scene");
  write("scene.png", "Images (*.png)", [content](const std::string&) {
    const auto bytes = mapping::encode_image(content->color, ".png");
    return std::string(bytes.begin(), bytes.end());
  });
}

void Exporter::points() {
  if (const auto object = browser_.selection().object())
    return write(QString("object_%1.ply").arg(*object), "Point clouds (*.ply)",
                 [memory = browser_.shared_data(), id = *object, time = browser_.selection().time(),
                  known_at = browser_.selection().known_at()](const std::string&) {
                   const ColoredCloud cloud = memory->object_cloud(id, time, known_at);
                   if (cloud.points.empty())
                     throw Error(memory::object_name(id) + " has no points: no depth is stored for it");
                   return cloud_ply(cloud);
                 });
  const auto cloud = browser_.moment().cloud;
  if (cloud == nullptr || cloud->points.empty()) return message("This scene has no points");
  write("scene.ply", "Point clouds (*.ply)", [cloud](const std::string&) { return cloud_ply(*cloud); });
}

void Exporter::map() {
  if (browser_.data()->world() == nullptr) return message("This memory has no map");
  write("map.urdf", "Maps (*.urdf)",
        [memory = browser_.shared_data()](const std::string&) { return urdf_text(*memory->world()); });
}

void Exporter::report() {
  write("memory.html", "Pages (*.html)", [path = browser_.data()->info().path](const std::string&) {
    NoProgress progress;
    return memory_report(memory::Store::open_read(path), std::nullopt, {}, progress);
  });
}

}  // namespace loci::gui
