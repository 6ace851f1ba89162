#include "gui/window/object_editor.h"

#include <QFileInfo>
#include <QInputDialog>

namespace loci::gui {

ObjectEditor::ObjectEditor(Browser& browser, EditHistory& edits, QWidget* window)
    : QObject(window), browser_(browser), edits_(edits), window_(window) {}

bool ObjectEditor::can_edit() const {
  return browser_.data() != nullptr &&
         QFileInfo(QString::fromStdString(browser_.data()->info().path)).isWritable();
}

const BelievedObject* ObjectEditor::edited_object() {
  const BelievedObject* object = browser_.selected_object();
  if (!can_edit())
    Q_EMIT message("This file is read-only");
  else if (object == nullptr)
    Q_EMIT message("Select an object first");
  return can_edit() ? object : nullptr;
}

std::optional<QString> ObjectEditor::ask(const QString& title, const QString& question, const QString& now) {
  bool accepted = false;
  const QString text =
      QInputDialog::getText(window_, title, question, QLineEdit::Normal, now, &accepted).trimmed();
  return accepted ? std::optional(text) : std::nullopt;
}

void ObjectEditor::edit_fact(const QString& title, const std::string& key, const std::string& now) {
  const BelievedObject* object = edited_object();
  if (object == nullptr) return;
  const std::string id = memory::object_name(object->object);
  const auto value =
      ask(title, QString("%1 of %2 (empty removes it):").arg(title, QString::fromStdString(id)),
          now == id ? QString() : QString::fromStdString(now));
  if (value) edits_.set_fact(id, key, value->toStdString());
}

void ObjectEditor::set_class() {
  const BelievedObject* object = browser_.selected_object();
  edit_fact("Class", "class", object == nullptr ? "" : browser_.belief().names->class_of(object->object));
}

void ObjectEditor::set_owner() {
  const BelievedObject* object = browser_.selected_object();
  edit_fact("Owner", "owner", object == nullptr ? "" : browser_.belief().names->owner_of(object->object));
}

void ObjectEditor::rename() {
  const QString place = QString::fromStdString(browser_.selection().place());
  if (!place.isEmpty()) return rename_place(place);
  const BelievedObject* object = browser_.selected_object();
  edit_fact("Name", "alias", object == nullptr ? "" : browser_.belief().name_of(*object));
}

void ObjectEditor::rename_place(const QString& place) {
  if (!can_edit()) return message("This file is read-only");
  const auto name = ask("Name", QString("Name of %1 (empty removes it):").arg(place), place);
  if (!name || *name == place) return;
  // The place stays selected under its new name.
  auto* until_written = new QObject(this);
  connect(&edits_, &EditHistory::written, until_written, [this, name = *name, until_written] {
    if (!name.isEmpty()) browser_.selection().select_place(name.toStdString());
    until_written->deleteLater();
  });
  connect(&edits_, &EditHistory::failed, until_written, [until_written] { until_written->deleteLater(); });
  edits_.name_part(place.toStdString(), name->toStdString());
}

void ObjectEditor::merge() {
  const BelievedObject* object = edited_object();
  if (object == nullptr) return;
  QStringList names;
  std::vector<int64_t> ids;
  const Belief& belief = browser_.belief();
  for (const BelievedObject& other : belief.objects) {
    if (other.object == object->object) continue;
    QStringList facts = {QString::fromStdString(other.color.value_or(""))};
    facts << QString::fromStdString(belief.place_of(other));
    facts.removeAll("");
    names << QString("%1 (%2)").arg(QString::fromStdString(belief.name_of(other)), facts.join(", "));
    ids.push_back(other.object);
  }
  if (names.isEmpty()) return message("There is no other object at this time");
  bool accepted = false;
  const QString other = QInputDialog::getItem(
      window_, "Merge objects",
      QString("%1 is the same object as:").arg(QString::fromStdString(belief.name_of(*object))), names, 0,
      false, &accepted);
  if (accepted) edits_.merge(object->object, ids[static_cast<size_t>(names.indexOf(other))]);
}

void ObjectEditor::split() {
  if (const BelievedObject* object = edited_object())
    edits_.split(object->object, browser_.selection().time());
}

void ObjectEditor::label() {
  const BelievedObject* object = edited_object();
  const memory::SceneRow* scene = browser_.scene();
  const SceneContent* content = browser_.moment().content.get();
  if (object == nullptr || scene == nullptr || content == nullptr) return;
  for (const ImageBox& box : content->boxes) {
    if (box.object != object->object) continue;
    const auto label = ask("Label", "Class of this object in the image (empty removes it):",
                           QString::fromStdString(browser_.belief().names->class_of(object->object)));
    if (label) edits_.label(scene->id, box.number, label->toStdString());
    return;
  }
  Q_EMIT message("The selected object is not in this image");
}

QString ObjectEditor::ask_for_joint() {
  const mapping::World* world = browser_.data() == nullptr ? nullptr : browser_.data()->world();
  if (!can_edit() || world == nullptr) {
    Q_EMIT message(world == nullptr ? "This memory has no map" : "This file is read-only");
    return {};
  }
  QStringList joints;
  int present = 0;
  for (const mapping::Joint& joint : world->joints) {
    if (joint.child == browser_.selection().place()) present = joints.size();
    joints << QString::fromStdString(joint.name);
  }
  bool accepted = false;
  const QString joint =
      QInputDialog::getItem(window_, "Joint", "Joint to correct:", joints, present, false, &accepted);
  return accepted ? joint : QString();
}

void ObjectEditor::rename_joint() {
  const QString joint = ask_for_joint();
  if (joint.isEmpty()) return;
  const auto name = ask("Name of a joint", QString("Name of %1 (empty removes it):").arg(joint), joint);
  if (name && *name != joint) edits_.name_part(joint.toStdString(), name->toStdString());
}

void ObjectEditor::set_joint_type() {
  const QString joint = ask_for_joint();
  if (joint.isEmpty()) return;
  bool accepted = false;
  const QString type =
      QInputDialog::getItem(window_, "Joint", "Type of " + joint + ":",
                            {"fixed", "revolute", "continuous", "prismatic"}, 0, false, &accepted);
  if (accepted) edits_.set_joint_type(joint.toStdString(), type.toStdString());
}

}  // namespace loci::gui
