// The menu File > Export: what is chosen, as files. Each tip names the command that writes the same.

#include <QAction>
#include <QBuffer>
#include <QFileDialog>
#include <QMenu>

#include "gui/background.h"
#include "gui/data/exports.h"
#include "gui/data/object_details.h"
#include "gui/main_window.h"
#include "gui/text.h"
#include "mapping/base/error.h"
#include "mapping/base/files.h"
#include "mapping/image/image_io.h"
#include "mapping/world/urdf.h"
#include "memory/report/memory_report.h"
#include "memory/store/store.h"

namespace loci::gui {
namespace {

/// What is believed of the chosen object, or of what is at the chosen place; everything when nothing is
/// chosen.
BelievedScene chosen_part(BelievedScene belief, const SelectionModel& selection) {
  if (!selection.object() && selection.place().empty()) return belief;
  std::erase_if(belief.objects, [&](const BelievedObject& object) {
    return selection.object() ? object.id != *selection.object() : object.place != selection.place();
  });
  return belief;
}

}  // namespace

void MainWindow::build_export_menu(QMenu* file) {
  QMenu* menu = file->addMenu("&Export");
  const auto add = [&](const QString& text, const QString& tip, void (MainWindow::*run)()) {
    add_action(menu, {text, {}, tip}, [this, run] {
      if (browser_.data() == nullptr) return tell("Open a memory first");
      (this->*run)();
    });
  };
  add("&Table of what is believed…",
      "What is believed at the chosen time of the chosen object or place, else of all, as CSV or JSON: "
      "loci-memory objects --at TIME --json, loci-memory on PLACE --json",
      &MainWindow::export_table);
  add("&Images of the object…", "The chosen object's images from all sides: loci-memory model OBJECT",
      &MainWindow::export_images);
  add("&Scene's image…", "Colour image of the chosen scene: loci-memory report", &MainWindow::export_scene);
  add("Measured &points…",
      "The points of the chosen scene as PLY in the map frame, or of the chosen object as it was seen "
      "last, as fine as they are kept: loci-memory export -o FOLDER --clouds, loci-memory model OBJECT",
      &MainWindow::export_cloud);
  add("&Map…", "The map as URDF, with what people corrected in it: loci-memory export -o FOLDER --map",
      &MainWindow::export_map);
  add("&Report…", "A page about the whole memory: loci-memory report -o FILE", &MainWindow::export_report);
}

void MainWindow::export_to(const QString& name, const QString& filter,
                           const std::function<std::string(const std::string& path)>& content) {
  const QString path = QFileDialog::getSaveFileName(this, "Export", name, filter);
  if (path.isEmpty()) return;
  in_background<bool>(
      this,
      [path = path.toStdString(), content] {
        write_file_atomically(path, content(path));
        return true;
      },
      [this, path](bool&) { tell("Saved " + path); },
      [this](const std::exception_ptr& error) { Q_EMIT browser_.failed(reason_of(error)); });
}

void MainWindow::export_table() {
  export_to("believed.csv", "Tables (*.csv);;JSON (*.json)",
            [belief = chosen_part(browser_.belief(), browser_.selection())](const std::string& path) {
              return path.ends_with(".json") ? believed_json(belief) : believed_csv(belief);
            });
}

void MainWindow::export_images() {
  const auto object = browser_.selection().object();
  if (!object) return tell("Choose an object first");
  const QString folder = QFileDialog::getExistingDirectory(this, "Folder for the images");
  if (folder.isEmpty()) return;
  in_background<size_t>(
      this,
      [memory = browser_.shared_data(), id = *object, time = browser_.selection().time(),
       path = std::filesystem::path(folder.toStdString())] {
        const std::vector<ObjectImage> images = memory->details(id, time).images;
        for (size_t i = 0; i < images.size(); ++i)
          mapping::write_image(path / ("object_" + std::to_string(id) + "_" + std::to_string(i + 1) + ".png"),
                               images[i].image);
        return images.size();
      },
      [this, folder](size_t& count) { tell(QString("Saved %1 images in %2").arg(count).arg(folder)); },
      [this](const std::exception_ptr& error) { Q_EMIT browser_.failed(reason_of(error)); });
}

void MainWindow::export_scene() {
  const auto content = browser_.moment().content;
  if (content == nullptr || content->color.empty()) return tell("No image was kept for this scene");
  export_to("scene.png", "Images (*.png)", [content](const std::string&) {
    const auto bytes = mapping::encode_image(content->color, ".png");
    return std::string(bytes.begin(), bytes.end());
  });
}

void MainWindow::export_cloud() {
  if (const auto object = browser_.selection().object())
    return export_to(QString("object_%1.ply").arg(*object), "Clouds (*.ply)",
                     [memory = browser_.shared_data(), id = *object, time = browser_.selection().time(),
                      known_at = browser_.selection().known_at()](const std::string&) {
                       const ColoredCloud cloud = memory->object_cloud(id, time, known_at);
                       if (cloud.points.empty())
                         throw Error(memory::object_name(id) + " has no points: no depth was kept of it");
                       return cloud_ply(cloud);
                     });
  const auto cloud = browser_.moment().cloud;
  if (cloud == nullptr || cloud->points.empty()) return tell("This scene has no points");
  export_to("scene.ply", "Clouds (*.ply)", [cloud](const std::string&) { return cloud_ply(*cloud); });
}

void MainWindow::export_map() {
  if (browser_.data()->world() == nullptr) return tell("This memory has no map");
  export_to("map.urdf", "Maps (*.urdf)",
            [memory = browser_.shared_data()](const std::string&) { return urdf_text(*memory->world()); });
}

void MainWindow::export_report() {
  export_to("memory.html", "Pages (*.html)", [path = browser_.data()->info().path](const std::string&) {
    NoProgress progress;
    return memory_report(memory::Store::open_read(path), std::nullopt, {}, progress);
  });
}

}  // namespace loci::gui
