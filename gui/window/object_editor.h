#pragma once

#include <QObject>
#include <string>

#include "gui/data/browser.h"
#include "gui/data/edit_history.h"

class QWidget;

namespace loci::gui {

/// Corrections of the selected object, place or joint: asks for values in dialogs and writes them through the
/// edit history.
class ObjectEditor : public QObject {
  Q_OBJECT

 public:
  ObjectEditor(Browser& browser, EditHistory& edits, QWidget* window);

  /// Whether a memory is open whose file may be written.
  bool can_edit() const;
  /// The name of the selected object, place or part of the map.
  void rename();
  void set_class();
  void set_owner();
  /// The selected object and another are one.
  void merge();
  /// What is seen of the selected object from the selected time on is another object.
  void split();
  /// The class of the selected object in the shown image, as a training label.
  void label();
  void rename_joint();
  void set_joint_type();

 Q_SIGNALS:
  void message(const QString& text);  ///< for the status bar

 private:
  /// The selected object when it can be edited, else nullptr and a message.
  const BelievedObject* edited_object();
  void rename_place(const QString& place);
  void edit_fact(const QString& title, const std::string& key, const std::string& now);
  /// Asks for one joint of the map; empty = none.
  QString ask_for_joint();
  /// Asks for a line of text; unset = cancelled.
  std::optional<QString> ask(const QString& title, const QString& question, const QString& now = {});

  Browser& browser_;
  EditHistory& edits_;
  QWidget* window_;
};

}  // namespace loci::gui
