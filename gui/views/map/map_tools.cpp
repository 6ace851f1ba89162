#include "gui/views/map/map_tools.h"

#include <QCheckBox>
#include <QComboBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QRegularExpression>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "gui/core/theme.h"
#include "gui/views/map/map_view.h"
#include "mapping/base/math/math.h"

namespace loci::gui {
namespace {

constexpr int kSliderSteps = 200;  // of a slider
const QSize kMinSize(200, 160);

QLabel* heading(const QString& text, QWidget* parent) {
  auto* label = new QLabel(text, parent);
  label->setFont(bold_font(label->font()));
  return label;
}

double position_of(const QSlider& slider, double lower, double upper) {
  return lower + (upper - lower) * slider.value() / kSliderSteps;
}

bool is_movable(const mapping::Joint& joint) {
  if (joint.mimic) return false;
  return joint.type == mapping::JointType::continuous ||
         ((joint.type == mapping::JointType::revolute || joint.type == mapping::JointType::prismatic) &&
          joint.limits && joint.limits->upper > joint.limits->lower);
}

}  // namespace

MapTools::MapTools(Browser& browser, MapView& map, QWidget* parent)
    : Page(parent), browser_(browser), map_(map) {
  auto* layout = new QVBoxLayout(this);
  layout->setContentsMargins(8, 6, 8, 6);
  setMinimumSize(kMinSize);  // the joints scroll
  build_measuring(*layout);
  build_section(*layout);
  build_joints(*layout);
  connect(&browser_, &Browser::opened, this, &MapTools::refresh);
  connect(&browser_, &Browser::belief_changed, this, &MapTools::refresh);
}

void MapTools::build_measuring(QVBoxLayout& layout) {
  ruler_ = new QToolButton(this);
  ruler_->setText("Measure");
  ruler_->setCheckable(true);
  ruler_->setToolTip(
      "Two clicks in the map: how far they are apart. Points that were measured come before "
      "surfaces of the map");
  measured_ = new QLabel(this);
  measured_->setWordWrap(true);
  measured_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  auto* row = new QHBoxLayout;
  row->addWidget(ruler_, 0, Qt::AlignTop);
  row->addWidget(measured_, 1);
  layout.addLayout(row);
  const auto tell = [this](const QString& text) {
    measured_->setText(!text.isEmpty()       ? text
                       : ruler_->isChecked() ? "Click two points in the map."
                                             : "Distance between two points");
    measured_->setEnabled(!text.isEmpty() || ruler_->isChecked());
  };
  connect(&map_, &MapView::measured, this, tell);
  connect(ruler_, &QToolButton::toggled, &map_, &MapView::set_measuring);
  tell({});
}

void MapTools::build_section(QVBoxLayout& layout) {
  layout.addWidget(heading("Section", this));
  section_ = new QComboBox(this);
  section_->addItems({"Nothing cut", "Across x", "Across y", "Across z (height)"});
  section_->setToolTip("Cuts map and cloud open; objects stay, so that what is in cupboards is seen");
  section_above_ = new QCheckBox("other side", this);
  section_above_->setToolTip("Shows what lies beyond the cut instead of what lies before it");
  section_at_ = new QSlider(Qt::Horizontal, this);
  section_at_->setRange(0, kSliderSteps);
  section_at_->setValue(kSliderSteps / 2);
  section_at_->setToolTip("Where it is cut");
  section_text_ = new QLabel(this);
  section_text_->setMinimumWidth(fontMetrics().horizontalAdvance("-00.00 m"));
  auto* first = new QHBoxLayout;
  first->addWidget(section_, 1);
  first->addWidget(section_above_);
  auto* second = new QHBoxLayout;
  second->addWidget(section_at_, 1);
  second->addWidget(section_text_);
  layout.addLayout(first);
  layout.addLayout(second);
  connect(section_, QOverload<int>::of(&QComboBox::currentIndexChanged), this, &MapTools::take_section);
  connect(section_at_, &QSlider::valueChanged, this, &MapTools::take_section);
  connect(section_above_, &QCheckBox::toggled, this, &MapTools::take_section);
  take_section();
}

void MapTools::build_joints(QVBoxLayout& layout) {
  put_back_ = new QToolButton(this);
  put_back_->setText("As believed");
  put_back_->setToolTip("All joints as they are believed to be at the selected time");
  auto* head = new QHBoxLayout;
  head->addWidget(heading("Doors and drawers", this), 1);
  head->addWidget(put_back_);
  layout.addLayout(head);
  empty_ = new QLabel(this);
  empty_->setWordWrap(true);
  empty_->setEnabled(false);
  layout.addWidget(empty_);
  area_ = new QScrollArea(this);
  area_->setWidgetResizable(true);
  area_->setFrameShape(QFrame::NoFrame);
  area_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  layout.addWidget(area_, 1);
  connect(put_back_, &QToolButton::clicked, this, [this] {
    map_.set_joints_by_hand({});
    show_values();
  });
}

QSlider* MapTools::slider(const std::string& joint) const {
  for (const JointRow& row : rows_)
    if (row.name == joint) return row.slider;
  return nullptr;
}

void MapTools::refresh() {
  if (!is_in_front()) return;
  if (!listed_ || filled_ != browser_.shared_data()) {
    listed_ = true;
    filled_ = browser_.shared_data();
    fill_joints(filled_ == nullptr ? nullptr : filled_->world());
  }
  show_values();
}

void MapTools::fill_joints(const mapping::World* world) {
  rows_.clear();
  auto* list = new QWidget;
  auto* grid = new QGridLayout(list);
  grid->setContentsMargins(0, 0, 4, 0);
  grid->setColumnStretch(1, 1);
  for (const mapping::Joint& joint : world == nullptr ? std::vector<mapping::Joint>() : world->joints) {
    if (!is_movable(joint)) continue;
    JointRow row{.name = joint.name, .turns = joint.type != mapping::JointType::prismatic};
    row.lower = joint.limits && joint.type != mapping::JointType::continuous ? joint.limits->lower : -kPi;
    row.upper = joint.limits && joint.type != mapping::JointType::continuous ? joint.limits->upper : kPi;
    row.slider = new QSlider(Qt::Horizontal, list);
    row.slider->setRange(0, kSliderSteps);
    row.value = new QLabel(list);
    row.value->setAlignment(Qt::AlignRight | Qt::AlignVCenter);
    row.value->setMinimumWidth(fontMetrics().horizontalAdvance("-180°  "));
    const QString name = QString::fromStdString(joint.name);
    const int room = fontMetrics().horizontalAdvance("drawer_10_front");
    auto* label = new QLabel(
        fontMetrics().elidedText(QString(name).remove(QRegularExpression("_joint$")), Qt::ElideMiddle, room),
        list);
    row.slider->setToolTip(QString("%1: moves %2").arg(name, QString::fromStdString(joint.child)));
    label->setToolTip(row.slider->toolTip());
    const int line = static_cast<int>(rows_.size());
    grid->addWidget(label, line, 0);
    grid->addWidget(row.slider, line, 1);
    grid->addWidget(row.value, line, 2);
    connect(row.slider, &QSlider::valueChanged, this, &MapTools::take_joints);
    rows_.push_back(row);
  }
  grid->setRowStretch(static_cast<int>(rows_.size()), 1);
  area_->setWidget(list);
  area_->setVisible(!rows_.empty());
  put_back_->setVisible(!rows_.empty());
  empty_->setVisible(rows_.empty());
  empty_->setText(browser_.data() == nullptr ? "Open a memory to move what its map can move."
                  : world == nullptr
                      ? "This memory was made without a map: give loci-perceive run --map MAP.urdf."
                      : "Nothing in this map can be moved.");
}

void MapTools::show_values() {
  const JointState joints = map_.joints();
  for (const JointRow& row : rows_) {
    const auto found = joints.find(row.name);
    const double position = found == joints.end() ? 0 : found->second;
    const QSignalBlocker quiet(row.slider);
    row.slider->setValue(
        static_cast<int>(std::lround(kSliderSteps * (position - row.lower) / (row.upper - row.lower))));
    row.value->setText(row.turns ? QString("%1°").arg(position * 180 / kPi, 0, 'f', 0)
                                 : QString("%1 cm").arg(position * 100, 0, 'f', 0));
  }
}

void MapTools::take_joints() {
  JointState joints = map_.joints();
  for (const JointRow& row : rows_)
    if (row.slider == sender()) joints[row.name] = position_of(*row.slider, row.lower, row.upper);
  map_.set_joints_by_hand(joints);
  show_values();
}

void MapTools::take_section() {
  const int axis = section_->currentIndex() - 1;
  const Eigen::AlignedBox3d all = map_.scene().bounds();
  const bool cuts = axis >= 0 && !all.isEmpty();
  section_at_->setEnabled(axis >= 0);
  section_above_->setEnabled(axis >= 0);
  section_text_->clear();
  if (!cuts) return map_.set_section({});
  const double at = position_of(*section_at_, all.min()[axis], all.max()[axis]);
  section_text_->setText(QString("%1 m").arg(at, 0, 'f', 2));
  map_.set_section(MapSection{axis, at, !section_above_->isChecked()});
}

}  // namespace loci::gui
