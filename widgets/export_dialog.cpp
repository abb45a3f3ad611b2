// SPDX-License-Identifier: GPL-3.0-or-later
#include "widgets/export_dialog.h"
#include "core/params/param_text.h"
#include "widgets/panel_parts.h"
#include <QCheckBox>
#include <QComboBox>
#include <QDir>
#include <QFile>
#include <QFileDialog>
#include <QFileInfo>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QLineEdit>
#include <QProgressBar>
#include <QPushButton>
#include <QVBoxLayout>

namespace lightloom {

namespace {

std::filesystem::path pathOf(const QString& name) { return QFile::encodeName(name).toStdString(); }

QCheckBox* box(const QString& text, const QString& tip, const char* name, bool isOn)
{
    auto* out = new QCheckBox(text);
    out->setToolTip(tip);
    out->setObjectName(QString::fromLatin1(name));
    out->setChecked(isOn);
    return out;
}

} // namespace

ExportDialog::ExportDialog(QWidget* parent, std::function<std::optional<ExportOrder>()> order)
    : QDialog(parent), order_(std::move(order))
{
    setWindowTitle(tr("Export"));
    setObjectName(QStringLiteral("exportDialog"));
    gltf_ = box(tr("Scene with its light (.glb, and .exr beside it)"),
                tr("For three.js and others: the lightmap lies on TEXCOORD_1 and is named by MOZ_lightmap"),
                "export.gltf", true);
    lightmap_ = box(tr("Lightmap (.exr)"), tr("Illuminance in lux on every surface, 32-bit float RGB"),
                    "export.lightmap", true);
    volume_ =
        box(tr("Volume (.vdb)"), tr("What the bake keeps as OpenVDB grids, an octree's leaves or a grid's vertices"),
            "export.volume", false);
    direct_ = box(tr("Direct light too"), tr("Into the lightmap; the .glb then has no lamps"), "export.direct", false);
    sceneUv_ = box(tr("The scene's own second UV set"),
                   tr("Instead of new charts; it must lie in 0..1 and overlap nowhere"), "export.sceneUv", false);
    size_ = new QComboBox;
    size_->setObjectName(QStringLiteral("export.size"));
    for (int size = 256; size <= kMostAtlas; size *= 2) size_->addItem(tr("%1 x %1 texels").arg(size), size);
    size_->setCurrentIndex(2);
    place_ = new QLineEdit;
    place_->setObjectName(QStringLiteral("export.place"));
    place_->setToolTip(tr("Folder and name; the endings are added"));
    auto* browse = new QPushButton(tr("&Browse..."));
    auto* places = new QHBoxLayout;
    places->addWidget(place_, 1);
    places->addWidget(browse);
    state_ = textLines();
    state_->setObjectName(QStringLiteral("export.state"));
    state_->setWordWrap(true);
    state_->setMinimumSize(440, 3 * fontMetrics().lineSpacing());
    state_->setAlignment(Qt::AlignTop | Qt::AlignLeft);
    progress_ = thinProgress(tr("Progress of the export"));
    go_ = new QPushButton(tr("&Export"));
    go_->setObjectName(QStringLiteral("export.go"));
    go_->setDefault(true);
    cancel_ = new QPushButton(tr("Close"));
    cancel_->setObjectName(QStringLiteral("export.cancel"));
    auto* buttons = new QHBoxLayout;
    buttons->addStretch(1);
    buttons->addWidget(go_);
    buttons->addWidget(cancel_);

    auto* form = new QFormLayout;
    auto* what = new QVBoxLayout;
    for (QCheckBox* each : {gltf_, lightmap_, volume_}) what->addWidget(each);
    form->addRow(tr("Files"), what);
    auto* where = new QLabel(tr("&Where"));
    where->setBuddy(place_);
    form->addRow(where, places);
    form->addRow(tr("&Atlas"), size_);
    form->addRow(QString(), sceneUv_);
    about_ = textLines();
    about_->setObjectName(QStringLiteral("export.light"));
    about_->setWordWrap(true);
    auto* light = new QVBoxLayout;
    light->addWidget(about_);
    light->addWidget(direct_);
    form->addRow(tr("Light"), light);
    auto* column = new QVBoxLayout(this);
    column->addLayout(form);
    column->addWidget(state_);
    column->addWidget(progress_);
    column->addLayout(buttons);

    for (QCheckBox* each : {gltf_, lightmap_, volume_}) {
        connect(each, &QCheckBox::toggled, this, &ExportDialog::showState);
    }
    connect(place_, &QLineEdit::textChanged, this, &ExportDialog::showState);
    connect(browse, &QPushButton::clicked, this, &ExportDialog::choosePlace);
    connect(go_, &QPushButton::clicked, this, &ExportDialog::begin);
    connect(cancel_, &QPushButton::clicked, this, [this] {
        if (isRunning_) {
            worker_.cancel();
        } else {
            close();
        }
    });
    connect(
        &worker_, &ExportWorker::progressed, this, [this](double f) { setFraction(*progress_, f); },
        Qt::QueuedConnection);
    connect(&worker_, &ExportWorker::finished, this, &ExportDialog::end, Qt::QueuedConnection);
    showState();
}

void ExportDialog::setName(const QString& pathWithoutEnding)
{
    if (!place_->isModified()) place_->setText(pathWithoutEnding);
    lightChanged();
    if (!isRunning_) showState();
}

void ExportDialog::lightChanged()
{
    const std::optional<ExportOrder> order = order_();
    if (!order) return about_->setText(tr("No light yet"));
    const std::string& less = order->info.incomplete;
    about_->setText(less.empty() ? tr("Depth %1, finished").arg(order->view.snapshot.level)
                                 : tr("As shown now, which is %1").arg(QString::fromStdString(less)));
}

ExportRequest ExportDialog::request() const
{
    ExportRequest request;
    const QString place = place_->text();
    if (lightmap_->isChecked()) request.lightmap = pathOf(place + ".exr");
    if (gltf_->isChecked()) request.gltf = pathOf(place + ".glb");
    if (volume_->isChecked()) request.volume = pathOf(place + ".vdb");
    request.atlas.size = size_->currentData().toInt();
    request.atlas.useSceneUv = sceneUv_->isChecked();
    request.withDirect = direct_->isChecked();
    return request;
}

void ExportDialog::choosePlace()
{
    auto* dialog = new QFileDialog(this, tr("Export to"), place_->text());
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setAcceptMode(QFileDialog::AcceptSave);
    dialog->setOption(QFileDialog::DontConfirmOverwrite); // the endings are ours: showState tells what is replaced
    connect(dialog, &QFileDialog::fileSelected, this, [this](const QString& file) {
        const QFileInfo info(file);
        place_->setText(info.dir().filePath(info.completeBaseName()));
        place_->setModified(true);
    });
    dialog->open();
}

void ExportDialog::say(const QString& text) { state_->setText(breakable(text)); }

/// What pressing the button would do.
void ExportDialog::showState()
{
    if (isRunning_) return;
    const ExportRequest wanted = request();
    const QFileInfo place(place_->text());
    QStringList replaced;
    for (const auto& path : {lightmapFile(wanted), wanted.gltf, wanted.volume}) {
        const QFileInfo file(QFile::decodeName(path.string().c_str()));
        if (!path.empty() && file.exists()) replaced += file.fileName();
    }
    const std::optional<ExportOrder> order = order_();
    const Result<Method> method = methodNamed(order ? order->view.snapshot.field->method() : "light-octree");
    const Result<Done> fine = checkExport(wanted, method ? *method : Method::lightOctree);
    const bool hasPlace = !place.fileName().isEmpty() && place.dir().exists();
    go_->setEnabled(fine && hasPlace);
    say(!fine                ? QString::fromStdString(fine.error().message)
        : !hasPlace          ? tr("There is no folder %1").arg(place.dir().path())
        : replaced.isEmpty() ? QString()
                             : tr("Replaces %1").arg(replaced.join(", ")));
}

void ExportDialog::begin()
{
    std::optional<ExportOrder> order = order_();
    if (!order) {
        say(tr("There is no bake to export yet"));
        return;
    }
    order->request = request();
    isRunning_ = true;
    go_->setEnabled(false);
    cancel_->setText(tr("Cancel"));
    say(tr("Unwrapping and lighting..."));
    setFraction(*progress_, 0.0);
    worker_.start(*std::move(order));
}

void ExportDialog::end(const QStringList& files, const QString& report, const QString& problem, bool isCancelled)
{
    isRunning_ = false;
    cancel_->setText(tr("Close"));
    setFraction(*progress_, files.isEmpty() ? 0.0 : 1.0);
    showState();
    if (isCancelled) {
        say(tr("Cancelled; no file was written"));
    } else if (!problem.isEmpty()) {
        say(problem);
    } else {
        QStringList names;
        for (const QString& file : files) names += QFileInfo(file).fileName();
        say(tr("Wrote %1. %2").arg(names.join(", "), report));
        Q_EMIT exported(files);
    }
}

} // namespace lightloom
