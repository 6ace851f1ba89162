#pragma once

#include <QFrame>
#include <QUrl>
#include <memory>
#include <vector>

#include "gui/data/browser.h"
#include "gui/models/question_text.h"

class QAction;
class QLabel;
class QLineEdit;
class QListWidget;
class QTextBrowser;

namespace loci::gui {

/// The command palette, over the middle of the window: a line for a question, a command of loci-memory or an
/// action of the window, with what completes it; the answers below, with objects, places and times that can
/// be clicked. "It" is the selected object, and a question without a time is asked at the selected time.
class QuestionBar : public QFrame {
  Q_OBJECT

 public:
  explicit QuestionBar(Browser& browser, QWidget* parent);

  /// What can be run from here beside questions.
  void set_actions(const QList<QAction*>& actions);
  /// Questions that were asked before, the newest first: of earlier starts, too.
  void set_asked(const QStringList& questions) { sources_.asked = questions; }
  const QStringList& asked() const { return sources_.asked; }
  /// Runs an action by its name; false when there is none.
  bool run_action(const QString& name);
  /// Shows the bar with the line ready to type.
  void open();
  /// Asks as if it had been typed; the answer comes when it is found.
  void ask(const QString& question);
  /// The selected link of an answer: object:12, place:table_1, time:08:30, ask:SENTENCE.
  void follow(const QUrl& link);
  /// Puts the bar where it belongs within the parent.
  void place_in(const QRect& area);

  QLineEdit* line() const { return line_; }
  QListWidget* suggestions() const { return list_; }
  QTextBrowser* answers() const { return answers_; }

 Q_SIGNALS:
  void asked_changed();

 protected:
  bool eventFilter(QObject* watched, QEvent* event) override;

 private:
  void forget();
  void load_words();
  void refresh_suggestions();
  void fit_height();
  void take_line();
  void take_suggestion(bool run);
  void show_answer(const TypedAnswer& answer);
  void move_in_list(int by);
  /// Puts an earlier (-1) or later (+1) question into the line.
  void recall(int by);

  Browser& browser_;
  QLineEdit* line_;
  QListWidget* list_;
  QTextBrowser* answers_;
  QLabel* hint_;
  QList<QAction*> actions_;
  SuggestionSources sources_;
  QStringList places_;
  QString html_;
  std::string memory_;  ///< path of the memory that was asked
  QRect area_;
  int recalled_ = -1;  ///< which of the questions asked before is in the line; -1 = none
};

}  // namespace loci::gui
