#pragma once
// Steps of read_task, in their order: terms, then the phases that contain them.

#include "manycontact/io/task_file.hpp"
#include "scene_parts.hpp"

namespace manycontact::io {

class TermReader {  // reads <cost> and <constraint> elements of a task on a scene
 public:
  explicit TermReader(const SceneFile& scene) : scene_(scene), ends_(scene) {}

  /// Reads a cost or constraint of a phase with the contacts flagged `active`, or, if `terminal`, of the terminal node.
  TaskTerm read(const Element& e, const std::vector<bool>& active, bool terminal);
  /// Returns the indices of the scene's contacts called `name`: one contact, or all copies of a contact.
  std::vector<int> contacts(const Where& where, const std::string& what, const std::string& name) const;

 private:
  void read_subject(const Element& e, TaskTerm& term);
  void read_contact(const Element& e, const std::vector<bool>& active, TaskTerm& term) const;
  void read_reference(const Element& e, const char* attribute, TaskTerm& term);
  void read_numbers(const Element& e, TaskTerm& term);
  void normalise_bases(const Element& e, TaskTerm& term) const;
  int reference_size(const TaskTerm& term) const;
  int rows(const TaskTerm& term) const;
  const SceneFile& scene_;
  EndReader ends_;
};

/// Throws InputError for attributes that only other residuals have.
void check_attributes(const Element& e, TaskResidual residual);

/// Returns whether a residual has an attribute, such as `frame` or `contact`.
bool takes(TaskResidual residual, const char* attribute);
/// Returns the number of rows of a residual, or 0 if this number depends on the robot or the contact.
int fixed_rows(TaskResidual residual);
TaskResidual read_residual(const Element& e);
void read_activation(const Element& e, TaskTerm& term);
void read_bounds(const Element& e, TaskTerm& term);

}  // namespace manycontact::io
