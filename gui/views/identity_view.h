#pragma once

#include "gui/browser.h"
#include "gui/views/page.h"

class QLabel;

namespace loci::gui {

class AssociationLines;
class DecisionMatrix;

/// Why things in the chosen scene were taken for what they are: lines to the scenes before, and the matrices
/// of similarity, proximity and identity.
class IdentityView : public Page {
  Q_OBJECT

 public:
  explicit IdentityView(Browser& browser, QWidget* parent = nullptr);

  AssociationLines& lines() { return *lines_; }
  DecisionMatrix& matrix() { return *matrix_; }

 protected:
  void look() override { refresh(); }

 private:
  void refresh();
  void show_decisions(std::vector<SceneDecisions>& scenes);

  Browser& browser_;
  QLabel* state_;
  AssociationLines* lines_;
  DecisionMatrix* matrix_;
};

}  // namespace loci::gui
