#include "gui/views/question_bar.h"

#include <QAction>
#include <QKeyEvent>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QScrollBar>
#include <QTextBrowser>
#include <QTextDocument>
#include <QVBoxLayout>
#include <algorithm>

#include "gui/core/background.h"
#include "gui/core/theme.h"
#include "gui/models/question_text.h"

namespace loci::gui {
namespace {

constexpr int kWidth = 600;
constexpr int kMargin = 10;
constexpr int kScrollBar = 40;  // room beside the words of an answer
constexpr size_t kSuggestions = 9;
constexpr int kAskedKept = 100;

QStringList to_list(const std::vector<std::string>& words) {
  QStringList list;
  for (const std::string& word : words) list << QString::fromStdString(word);
  return list;
}

QString plain_name(const QAction& action) {
  return action.text().remove('&').remove("…");
}

const char* kind_text(Suggestion::Kind kind) {
  switch (kind) {
    case Suggestion::Kind::asked:
      return "asked before";
    case Suggestion::Kind::example:
      return "question";
    case Suggestion::Kind::word:
      return "completion";
    case Suggestion::Kind::action:
      return "command";
  }
  return "";
}

struct Words {
  std::vector<std::string> names, examples;
};

}  // namespace

QuestionBar::QuestionBar(Browser& browser, QWidget* parent)
    : QFrame(parent),
      browser_(browser),
      line_(new QLineEdit(this)),
      list_(new QListWidget(this)),
      answers_(new QTextBrowser(this)),
      hint_(new QLabel("Enter asks · Tab completes · ↓ selects · ↑ asked before · Esc closes", this)) {
  setObjectName("question_bar");
  setFrameShape(QFrame::StyledPanel);
  setFrameShadow(QFrame::Raised);
  setAutoFillBackground(true);
  line_->setPlaceholderText("Ask: where is the red cup?");
  line_->setClearButtonEnabled(true);
  line_->installEventFilter(this);
  list_->setFocusPolicy(Qt::NoFocus);
  list_->setUniformItemSizes(true);
  list_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  list_->setTextElideMode(Qt::ElideRight);
  list_->setFrameShape(QFrame::NoFrame);
  answers_->setOpenLinks(false);
  answers_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  answers_->setFrameShape(QFrame::NoFrame);
  answers_->setFocusPolicy(Qt::ClickFocus);
  QFont small = small_font(font());
  hint_->setFont(small);
  hint_->setEnabled(false);
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(8, 8, 8, 6);
  layout->setSpacing(6);
  layout->addWidget(line_);
  layout->addWidget(list_);
  layout->addWidget(answers_);
  layout->addWidget(hint_);
  hide();
  connect(line_, &QLineEdit::textEdited, this, [this] {
    recalled_ = -1;
    refresh_suggestions();
  });
  connect(line_, &QLineEdit::textChanged, this, [this](const QString& text) {
    if (text.isEmpty()) refresh_suggestions();  // the clear button is no edit
  });
  connect(list_, &QListWidget::itemClicked, this, [this] { take_suggestion(true); });
  connect(answers_, &QTextBrowser::anchorClicked, this, &QuestionBar::follow);
  connect(&browser_, &Browser::opened, this, &QuestionBar::forget);
}

void QuestionBar::set_actions(const QList<QAction*>& actions) {
  actions_ = actions;
  sources_.actions.clear();
  for (const QAction* action : actions) sources_.actions << plain_name(*action);
}

void QuestionBar::forget() {
  sources_.words.clear();
  sources_.examples.clear();
  places_.clear();
  const std::string memory = browser_.data() == nullptr ? "" : browser_.data()->info().path;
  if (memory != memory_) {  // else it has grown: the answers stay
    html_.clear();
    answers_->clear();
  }
  memory_ = memory;
  if (isVisible()) load_words();
  refresh_suggestions();
}

void QuestionBar::load_words() {
  const auto memory = browser_.shared_data();
  if (memory == nullptr || !sources_.examples.isEmpty()) return;
  in_background<Words>(
      this,
      [memory] {
        return Words{memory->known_words(), memory->example_questions()};
      },
      [this, memory](const Words& words) {
        if (memory.get() != browser_.data()) return;
        sources_.words = to_list(words.names);
        sources_.examples = to_list(words.examples);
        for (const QString& word : sources_.words)
          if (!word.startsWith("object_")) places_ << word;
        refresh_suggestions();
      },
      [this](const std::exception_ptr& error) { Q_EMIT browser_.failed(reason_of(error)); });
}

void QuestionBar::open() {
  load_words();
  show();
  raise();
  recalled_ = -1;
  line_->setFocus();
  line_->selectAll();
  refresh_suggestions();
}

void QuestionBar::place_in(const QRect& area) {
  area_ = area;
  fit_height();
}

void QuestionBar::fit_height() {
  if (area_.isEmpty()) return;
  const int width = std::min(kWidth, area_.width() - 2 * kMargin);
  const int most = area_.height() - 2 * kMargin;
  list_->setFixedHeight(list_->count() * list_->sizeHintForRow(0) + 4);
  list_->setVisible(list_->count() > 0);
  const bool said = !html_.isEmpty() && !list_->isVisibleTo(this);
  answers_->setVisible(said);
  int height = line_->sizeHint().height() + hint_->sizeHint().height() + 30;
  if (list_->isVisibleTo(this)) height += list_->height();
  if (said) {
    answers_->document()->setTextWidth(width - kScrollBar);
    height += static_cast<int>(answers_->document()->size().height()) + 12;
  }
  setGeometry(area_.center().x() - width / 2, area_.top() + kMargin, width, std::min(height, most));
}

void QuestionBar::refresh_suggestions() {
  const QString typed = line_->text();
  list_->clear();
  // An answer stays to be read until something else is typed.
  if (typed.isEmpty() || line_->isModified())
    for (const Suggestion& suggestion : suggest(typed, sources_, kSuggestions)) {
      auto* item = new QListWidgetItem(suggestion.text, list_);
      item->setToolTip(kind_text(suggestion.kind));
      item->setData(Qt::UserRole, static_cast<int>(suggestion.kind));
      if (suggestion.kind == Suggestion::Kind::action) item->setText("› " + suggestion.text);
    }
  fit_height();
}

void QuestionBar::take_suggestion(bool run) {
  const QListWidgetItem* item = list_->currentItem();
  if (item == nullptr) return;
  const auto kind = static_cast<Suggestion::Kind>(item->data(Qt::UserRole).toInt());
  const QString text = kind == Suggestion::Kind::action ? item->text().mid(2) : item->text();
  line_->setText(text);
  line_->setModified(true);
  if (run && kind != Suggestion::Kind::word)
    take_line();
  else
    refresh_suggestions();
}

void QuestionBar::take_line() {
  const QString text = line_->text().trimmed();
  if (text.isEmpty()) return;
  if (run_action(text)) {
    line_->clear();
    hide();
  } else {
    ask(text);
  }
}

bool QuestionBar::run_action(const QString& name) {
  for (QAction* action : actions_)
    if (plain_name(*action).compare(name, Qt::CaseInsensitive) == 0) {
      action->trigger();
      return true;
    }
  return false;
}

void QuestionBar::ask(const QString& question) {
  const auto memory = browser_.shared_data();
  if (memory == nullptr) return;
  load_words();
  line_->setText(question);
  line_->setModified(false);
  sources_.asked.removeAll(question);
  sources_.asked.prepend(question);
  sources_.asked = sources_.asked.mid(0, kAskedKept);
  recalled_ = -1;
  Q_EMIT asked_changed();
  const TypedQuestion typed{question.toStdString(), browser_.selection().object(),
                            browser_.selection().time()};
  in_background<TypedAnswer>(
      this, [memory, typed] { return memory->answer(typed); },
      [this](const TypedAnswer& answer) { show_answer(answer); },
      [this](const std::exception_ptr& error) { Q_EMIT browser_.failed(reason_of(error)); });
}

void QuestionBar::show_answer(const TypedAnswer& answer) {
  const Theme theme = Theme::of(palette());
  const QString text = QString::fromStdString(answer.text).trimmed();
  QString html = QString("<p style='margin:8px 0 2px 0'><b>%1</b> <span style='color:%2'>%3</span></p>")
                     .arg(QString::fromStdString(answer.question).toHtmlEscaped(), theme.muted.name(),
                          QString::fromStdString(answer.command).toHtmlEscaped());
  html += "<p style='white-space:pre-wrap; margin:0'>" + linked_text(text, places_) + "</p>";
  if (!answer.nearest.empty()) html += "<p style='margin:4px 0 0 0'>What is understood, for example:</p>";
  for (const std::string& sentence : answer.nearest) {
    const QString line = QString::fromStdString(sentence).toHtmlEscaped();
    html += QString("<p style='margin:0 0 0 12px'><a href=\"ask:%1\">%1</a></p>").arg(line);
  }
  html_ = html + html_;  // the newest stands first
  answers_->setHtml(html_);
  refresh_suggestions();
  answers_->verticalScrollBar()->setValue(0);
  const auto objects = objects_named(text);
  if (objects.size() == 1) browser_.selection().select_object(objects.front());
}

void QuestionBar::follow(const QUrl& link) {
  const QString target = link.toString();
  const QString rest = target.section(':', 1);
  SelectionModel& selection = browser_.selection();
  if (target.startsWith("object:")) selection.select_object(rest.toLongLong());
  if (target.startsWith("place:")) selection.select_place(rest.toStdString());
  if (target.startsWith("ask:")) ask(rest);
  if (target.startsWith("time:"))
    browser_.reader().read<TimeNs>(
        this, "time", Urgency::moment,
        [text = rest.toStdString()](const OpenMemory& memory) { return memory.time_of(text); },
        [this](const TimeNs& time) { browser_.selection().set_time(time); });
}

void QuestionBar::move_in_list(int by) {
  if (list_->count() == 0) {  // from an answer back to what may be asked
    line_->setModified(true);
    refresh_suggestions();
  }
  const int row = list_->currentRow() + by;
  if (row < list_->count()) list_->setCurrentRow(row);  // above the first one is the line itself
}

/// As a shell does it: the line is that of the question, ready to be asked or changed.
void QuestionBar::recall(int by) {
  const int wanted = recalled_ - by;
  if (wanted >= sources_.asked.size()) return;
  recalled_ = std::max(wanted, -1);
  line_->setText(recalled_ < 0 ? QString() : sources_.asked[recalled_]);
  list_->clear();
  fit_height();
}

bool QuestionBar::eventFilter(QObject* watched, QEvent* event) {
  const bool asked_first = event->type() == QEvent::ShortcutOverride;
  if (watched != line_ || (event->type() != QEvent::KeyPress && !asked_first))
    return QFrame::eventFilter(watched, event);
  if (asked_first) {  // Esc closes this bar before it clears the selection.
    if (static_cast<QKeyEvent*>(event)->key() == Qt::Key_Escape) event->accept();
    return event->isAccepted();
  }
  switch (static_cast<QKeyEvent*>(event)->key()) {
    case Qt::Key_Down:
      recalled_ >= 0 ? recall(1) : move_in_list(1);
      return true;
    case Qt::Key_Up:
      list_->currentRow() >= 0 ? move_in_list(-1) : recall(-1);
      return true;
    case Qt::Key_Tab:
      if (list_->currentItem() == nullptr && list_->count() > 0) list_->setCurrentRow(0);
      take_suggestion(false);
      return true;
    case Qt::Key_Return:
    case Qt::Key_Enter:
      if (list_->currentItem() != nullptr)
        take_suggestion(true);
      else
        take_line();
      return true;
    case Qt::Key_Escape:
      hide();
      parentWidget()->setFocus();
      return true;
    default:
      return false;
  }
}

}  // namespace loci::gui
