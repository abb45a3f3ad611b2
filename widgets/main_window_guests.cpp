// SPDX-License-Identifier: GPL-3.0-or-later
// Objects that were not in the bake, put into its light.
#include "widgets/edit_command.h"
#include "widgets/guest_desk.h"
#include "widgets/main_window.h"
#include "widgets/message_bar.h"
#include "widgets/viewport.h"
#include <QAction>
#include <QFileDialog>
#include <QLabel>
#include <QSettings>
#include <QUndoStack>

namespace lightloom {

namespace {

constexpr int kGuestTurns = 3'000'000; ///< number of undo steps that may be joined, after those of lamps

} // namespace

void MainWindow::makeGuestActions()
{
    const auto addKind = [this](const QString& text, const QString& tip, GuestKind kind) {
        QAction* action = makeAction(text, {}, tip);
        connect(action, &QAction::triggered, this, [this, kind] { guestDesk_->add(kind); });
        addGuests_ += action;
    };
    addKind(tr("Add a &ball"), tr("A ball that was not in the bake, lit by it"), GuestKind::ball);
    addKind(tr("Add a &ring"), tr("A ring that was not in the bake, lit by it"), GuestKind::ring);
    addKind(tr("Add a &figure"), tr("A carved figure of 24,000 triangles that was not in the bake"), GuestKind::figure);
    addGuests_ += makeAction(tr("Add &glTF file..."), {}, tr("An object from a file (.glb, .gltf), lit by the bake"));
    connect(addGuests_.last(), &QAction::triggered, this, &MainWindow::chooseGuestFile);
    removeGuest_ = makeAction(tr("R&emove the object"), QKeySequence(Qt::Key_Delete),
                              tr("Take the object that was not in the bake away"));
    connect(removeGuest_, &QAction::triggered, this, [this] { guestDesk_->remove(); });
    removeGuest_->setEnabled(false);
}

void MainWindow::connectGuests()
{
    if (viewport_ == nullptr) {
        for (QAction* action : addGuests_) action->setEnabled(false);
        return;
    }
    guestDesk_ = new GuestDesk(viewport_, this);
    for (QAction* action : addGuests_) action->setEnabled(false); // there is no scene yet
    connect(this, &MainWindow::sceneOpened, this, [this] {
        for (QAction* action : addGuests_) action->setEnabled(true);
    });
    connect(guestDesk_, &GuestDesk::added, this, &MainWindow::guestAdded);
    connect(guestDesk_, &GuestDesk::present, removeGuest_, &QAction::setEnabled);
    connect(guestDesk_, &GuestDesk::edited, this, [this](const QString& what, const Guest& before, bool mayJoin) {
        const auto apply = [this](const Guest& guest) { guestDesk_->restore(guest); };
        undoStack_->push(new EditCommand<Guest>(what, before, guestDesk_->guest(), apply, mayJoin ? kGuestTurns : -1));
    });
    connect(guestDesk_, &GuestDesk::failed, this, [this](const QString& problem) { messages_->show(problem); });
}

void MainWindow::guestAdded(const QString& name)
{
    viewport_->setFocus();
    statusStage_->setText(tr("%1: drag it (Shift: up and down), the wheel turns it").arg(name));
    if (method_ == Method::irradianceGrid) return;
    messages_->show(tr("An octree knows light on the scene's surfaces only; a grid lights this object, too."),
                    tr("Show the grid"), [this] { (void)showMethod(Method::irradianceGrid); });
}

void MainWindow::chooseGuestFile()
{
    const QString folder = settings_ != nullptr ? settings_->value("folder").toString() : QString();
    auto* dialog = new QFileDialog(this, tr("Add an object"), folder, tr("glTF scenes (*.glb *.gltf);;All files (*)"));
    dialog->setObjectName(QStringLiteral("addGuest"));
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setFileMode(QFileDialog::ExistingFile);
    connect(dialog, &QFileDialog::fileSelected, this, [this](const QString& file) { guestDesk_->addFile(file); });
    dialog->open();
}

} // namespace lightloom
