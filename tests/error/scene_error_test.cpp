// One scene per defect, each with what the user reads about it, word for word; and the same on the command line.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "run_dalembert.hpp"

namespace dalembert::test {
namespace {

const std::string arm = ERROR_ROBOTS "/scenes/arm.urdf";

struct Case {
  const char* name;
  const char* scene;
  const char* messages;  // stderr
};

void PrintTo(const Case& c, std::ostream* os) { *os << c.name; }

// clang-format off
const Case defects[] = {
    {"unknown_key",
     "base: fixed\ngravty: none\n",
     "scene.yaml: line 2, column 1: key 'gravty': error: the key 'gravty' is unknown; did you mean 'gravity'?\n"},
    {"unknown_key_without_neighbour",
     "colour: red\n",
     "scene.yaml: line 1, column 1: key 'colour': error: the key 'colour' is unknown; choose from base, gravity, outputs, functions, coriolis, forward_dynamics, locked, cut, joints, mimic, jacobians, frames and 18 more\n"},
    {"comma_first",
     ", b\n",
     "scene.yaml: line 1, column 1: error: this is not YAML: a value was expected; share/doc/dalembert/docs/scene.md shows how a scene is written\n"},
    {"nested",
     "locked: [[[[[[[[[[[[[[[[waist]]]]]]]]]]]]]]]]\n",
     "scene.yaml: line 1, column 24: error: lists and maps are nested more than 16 deep; a scene needs six levels\n"},
    {"two_documents",
     "base: fixed\n---\nbase: floating\n",
     "scene.yaml: line 3, column 1: error: a second document begins here; a scene is one document: remove the line '---' and what is not needed\n"},
    {"plan_of_an_unknown_function",
     "base: fixed\nplan: {evaluat: {form: straight}}\n",
     "scene.yaml: line 2, column 8: key 'plan': error: the scene asks for no function 'evaluat'; did you mean 'evaluate'?\n"},
    {"plan_of_a_function_that_nobody_asks_for",
     "base: fixed\noutputs: [mass_matrix]\nplan: {forward_dynamics: {form: straight}}\n",
     "scene.yaml: line 3, column 8: key 'plan': error: the scene asks for no function 'forward_dynamics'; choose from evaluate\n"},
    {"plan_of_an_unknown_form",
     "base: fixed\nplan: {evaluate: {form: straigt}}\n",
     "scene.yaml: line 2, column 25: key 'plan': error: 'straigt' is unknown; did you mean 'straight'?\n"},
    {"plan_of_an_unknown_part",
     "base: fixed\nplan: {evaluate: {from: straight}}\n",
     "scene.yaml: line 2, column 19: key 'plan': error: 'from' is no part of a function's plan; did you mean 'form'?\n"},
    {"plan_of_loops_in_an_order",
     "base: fixed\nplan: {evaluate: {form: rolled, order: newest_first}}\n",
     "scene.yaml: line 2, column 18: key 'plan': error: 'evaluate' is rolled, and loops have no order of statements; leave the order out, or write form: straight\n"},
    {"plan_of_a_form_alone",
     "base: fixed\nplan: straight\n",
     "scene.yaml: line 2, column 7: key 'plan': error: the value is no map from functions to how they are computed; write plan: {evaluate: {form: straight}}, or let 'dalembert generate --plan measure' find it\n"},
    {"plan_to_measure",
     "base: fixed\nplan: measure\n",
     "scene.yaml: line 2, column 7: key 'plan': error: 'measure' is for the command line of generate and info; write what was measured: plan: {evaluate: {form: straight}}, or let 'dalembert generate --plan measure' find it\n"},
    {"plan_by_a_solver_of_nothing",
     "base: fixed\nplan: {evaluate: {solver: factorization}}\n",
     "scene key 'plan': error: the function 'evaluate' cannot be computed by factorization here; leave the solver out, or measure again with --plan measure\n"},
    {"base_value",
     "base: hanging\n",
     "scene.yaml: line 1, column 7: key 'base': error: 'hanging' is unknown; choose from fixed, floating\n"},
    {"base_list",
     "base: [fixed]\n",
     "scene.yaml: line 1, column 7: key 'base': error: the value is unknown; choose from fixed, floating\n"},
    {"gravity_word",
     "gravity: moon\n",
     "scene.yaml: line 1, column 10: key 'gravity': error: the value is no gravity; write [0, 0, -9.81], none, run_time, or {run_time: [0, 0, -9.81]}\n"},
    {"gravity_two_numbers",
     "gravity: [0, -9.81]\n",
     "scene.yaml: line 1, column 10: key 'gravity': error: the vector does not have three numbers; write [0, 0, -9.81], none, run_time, or {run_time: [0, 0, -9.81]}\n"},
    {"gravity_not_a_number",
     "gravity: [0, 0, g]\n",
     "scene.yaml: line 1, column 17: key 'gravity': error: 'g' is not a finite number; write a finite decimal number\n"},
    {"gravity_infinite",
     "gravity: [0, 0, .inf]\n",
     "scene.yaml: line 1, column 17: key 'gravity': error: '.inf' is not a finite number; write a finite decimal number\n"},
    {"gravity_run_time_value",
     "gravity: {run_time: 9.81}\n",
     "scene.yaml: line 1, column 21: key 'gravity': error: the vector does not have three numbers; write [0, 0, -9.81], none, run_time, or {run_time: [0, 0, -9.81]}\n"},
    {"functions_list",
     "functions: [mass_matrix]\n",
     "scene.yaml: line 1, column 12: key 'functions': error: the value is no map of functions; write functions: {balance: [mass_matrix, momentum_matrix]}\n"},
    {"function_of_an_unknown_quantity",
     "functions: {balance: [mass_matrix, momentum_matrx]}\n",
     "scene.yaml: line 1, column 36: key 'functions': error: the quantity 'momentum_matrx' is unknown; did you mean 'momentum_matrix'?\n"},
    {"function_of_an_unknown_link",
     "functions: {balance: [mass_matrix, jacobian_hnd]}\n",
     "scene.yaml: line 1, column 36: key 'functions': error: there is no link 'hnd'; did you mean 'hand'?\n"},
    {"function_of_a_link_cut_off",
     "functions: {balance: [mass_matrix, jacobian_hand]}\ncut: [hand]\n",
     "scene.yaml: line 1, column 36: key 'functions': error: link 'hand' is cut off; remove it here, or remove the link it hangs on from 'cut'\n"},
    {"function_of_a_link_that_rests",
     "base: fixed\nfunctions: {balance: [mass_matrix, jacobian_base]}\n",
     "arm.urdf: link 'base': error: jacobian_base is asked for of a link that does not move: the base is fixed; name a descendant of a joint that moves, or ask for base: floating\n"},
    {"function_of_a_link_twice",
     "functions: {look: [pose_hand, pose_hand]}\n",
     "scene.yaml: line 1, column 31: key 'functions': error: 'pose_hand' is given twice; keep one of them\n"},
    {"function_of_an_unknown_quantity_of_a_link",
     "functions: {look: [poses_hand]}\n",
     "scene.yaml: line 1, column 20: key 'functions': error: the quantity 'poses_hand' is unknown; did you mean 'pose_hand'?\n"},
    {"function_of_nothing",
     "functions: {balance: []}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: function 'balance' computes nothing; name at least one quantity, such as mass_matrix\n"},
    {"function_of_a_map",
     "functions: {balance: {mass_matrix: 1}}\n",
     "scene.yaml: line 1, column 36: key 'functions': error: which part of mass_matrix is asked for is no map; write {mass_matrix: {joints: [left_*]}}\n"},
    {"function_with_a_quantity_twice",
     "functions: {balance: [bias, bias]}\n",
     "scene.yaml: line 1, column 29: key 'functions': error: 'bias' is given twice; keep one of them\n"},
    {"function_twice",
     "functions: {balance: bias, balance: gravity}\n",
     "scene.yaml: line 1, column 28: key 'functions': error: 'balance' is given twice; keep one of them\n"},
    {"function_of_accelerations_and_forces",
     "functions: {plan: [mass_matrix, regressor, forward_dynamics_dq]}\n",
     "scene.yaml: line 1, column 44: key 'functions': error: 'forward_dynamics_dq' takes tau, and 'regressor' takes a: a function takes one of them; make two functions of it\n"},
    {"function_name_no_identifier",
     "functions: {2nd: bias}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: '2nd' cannot be the name of a function; give another name: letters, digits, and '_' between them, not starting with a digit\n"},
    {"function_name_with_underscores",
     "functions: {plan__step: bias}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: 'plan__step' cannot be the name of a function; give another name: letters, digits, and '_' between them, not starting with a digit\n"},
    {"function_name_keyword",
     "functions: {switch: bias}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: 'switch' is a keyword of C++; give another name: letters, digits, and '_' between them, not starting with a digit\n"},
    {"function_name_macro",
     "functions: {errno: bias}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: 'errno' is a name of the C++ library; give another name: letters, digits, and '_' between them, not starting with a digit\n"},
    {"function_name_assert",
     "functions: {assert: bias}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: 'assert' is a name of the C++ library; give another name: letters, digits, and '_' between them, not starting with a digit\n"},
    {"function_name_of_the_runtime",
     "functions: {DALEMBERT_INLINE: bias}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: 'DALEMBERT_INLINE' could be a macro of the generated code; give another name: letters, digits, and '_' between them, not starting with a digit\n"},
    {"function_name_of_a_guard",
     "functions: {ARM_C_API_H: bias}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: 'ARM_C_API_H' could be a macro of the generated code; give another name: letters, digits, and '_' between them, not starting with a digit\n"},
    {"function_name_of_a_variable",
     "functions: {state: bias}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: the generated code has another 'state'; call the function 'state' otherwise\n"},
    {"function_named_as_a_quantity",
     "functions: {gravity: bias}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: the generated code has another 'gravity'; call the function 'gravity' otherwise\n"},
    {"function_named_as_a_standard_one",
     "functions: {evaluate: bias}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: the generated code has another 'evaluate'; call the function 'evaluate' otherwise\n"},
    {"function_named_as_a_link_output",
     "functions: {twist_hand: bias}\nframes: [hand]\n",
     "scene.yaml: line 1, column 13: key 'functions': error: the generated code has another 'twist_hand'; call the function 'twist_hand' otherwise\n"},
    {"function_whose_result_is_a_quantity",
     "functions: {inverse: mass_matrix}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: the generated code has another 'inverse'; call the function 'inverse' otherwise\n"},
    {"function_whose_name_is_another_ones_result",
     "functions: {plan: bias, plan_bias: gravity}\n",
     "scene.yaml: line 1, column 25: key 'functions': error: the generated code has another 'plan_bias'; call the function 'plan_bias' otherwise\n"},
    {"functions_of_one_type",
     "functions: {plan_step: bias, planStep: gravity}\n",
     "scene.yaml: line 1, column 30: key 'functions': error: the generated code has another 'PlanStepScratch'; call the function 'planStep' otherwise\n"},
    {"function_of_coriolis_in_statics",
     "functions: {balance: [mass_matrix, coriolis_matrix]}\nrates_zero: true\n",
     "scene.yaml: line 1, column 36: key 'functions': error: coriolis_matrix is zero when rates_zero is set; remove one of the two\n"},
    {"unknown_output",
     "outputs: [mass_matrx]\n",
     "scene.yaml: line 1, column 11: key 'outputs': error: the quantity 'mass_matrx' is unknown; did you mean 'mass_matrix'?\n"},
    {"no_output",
     "outputs: []\n",
     "scene.yaml: line 1, column 1: key 'outputs': error: no output is asked for; name at least one quantity, such as mass_matrix\n"},
    {"output_twice",
     "outputs: [bias, gravity, bias]\n",
     "scene.yaml: line 1, column 26: key 'outputs': error: 'bias' is given twice; keep one of them\n"},
    {"outputs_map",
     "outputs: {bias: true}\n",
     "scene.yaml: line 1, column 17: key 'outputs': error: which part of bias is asked for is no map; write {bias: {joints: [left_*]}}\n"},
    {"part_of_an_output_twice",
     "outputs: [{mass_matrix: {joints: [elbow], joints: [wrist]}}]\n",
     "scene.yaml: line 1, column 43: key 'outputs': error: 'joints' is given twice; keep one of them\n"},
    {"unknown_locked",
     "locked: {elbo: 0.3}\n",
     "scene.yaml: line 1, column 10: key 'locked': error: there is no joint 'elbo'; did you mean 'elbow'?\n"},
    {"locked_value",
     "locked:\n  elbow: bent\n",
     "scene.yaml: line 2, column 10: key 'locked': error: 'bent' is not a finite number; write a finite decimal number\n"},
    {"locked_twice",
     "locked:\n  elbow: 0.3\n  wrist: 0\n  elbow: 0.4\n",
     "scene.yaml: line 4, column 3: key 'locked': error: 'elbow' is given twice; keep one of them\n"},
    {"locked_fixed_joint",
     "locked: [weld]\n",
     "scene.yaml: line 1, column 10: key 'locked': error: joint 'weld' is fixed; name a joint that moves, or remove it here\n"},
    {"locked_and_cut",
     "locked: {wrist: 0}\ncut: [fore]\n",
     "scene.yaml: line 1, column 10: key 'locked': error: joint 'wrist' is cut off; remove it here, or remove the link it belongs to from 'cut'\n"},
    {"unknown_cut",
     "cut: [hnd]\n",
     "scene.yaml: line 1, column 7: key 'cut': error: there is no link 'hnd'; did you mean 'hand'?\n"},
    {"cut_map",
     "cut: {hand: true}\n",
     "scene.yaml: line 1, column 6: key 'cut': error: the value is not a list; write a list of links\n"},
    {"cut_root",
     "cut: [base]\n",
     "scene.yaml: line 1, column 7: key 'cut': error: link 'base' is the root: nothing would be left; name a link below a joint\n"},
    {"mimic_word",
     "mimic: all\n",
     "scene.yaml: line 1, column 8: key 'mimic': error: the value is no map of mimic relations; write {joint: {of: other_joint, multiplier: 1, offset: 0}}, or urdf to take the URDF's relations\n"},
    {"mimic_multiplier",
     "mimic: {wrist: {of: elbow, multiplier: twice}}\n",
     "scene.yaml: line 1, column 40: key 'mimic': error: 'twice' is not a finite number; write a finite decimal number\n"},
    {"mimic_relation",
     "mimic: {wrist: elbow}\n",
     "scene.yaml: line 1, column 16: key 'mimic': error: the relation of 'wrist' is not a map; write {joint: {of: other_joint, multiplier: 1, offset: 0}}, or urdf to take the URDF's relations\n"},
    {"mimic_unknown_part",
     "mimic: {wrist: {of: elbow, factor: 2}}\n",
     "scene.yaml: line 1, column 28: key 'mimic': error: 'factor' is no part of a mimic relation; choose from of, multiplier, offset\n"},
    {"mimic_without_driver",
     "mimic: {wrist: {multiplier: 2}}\n",
     "scene.yaml: line 1, column 9: key 'mimic': error: the relation of 'wrist' does not say which joint drives it; write {joint: {of: other_joint, multiplier: 1, offset: 0}}, or urdf to take the URDF's relations\n"},
    {"mimic_driver_list",
     "mimic: {elbow: {of: [shoulder]}}\n",
     "scene.yaml: line 1, column 21: key 'mimic': error: what drives 'elbow' is not the name of a joint; write of: other_joint\n"},
    {"mimic_unknown_driver",
     "mimic: {wrist: {of: knee}}\n",
     "scene.yaml: line 1, column 17: key 'mimic': error: there is no joint 'knee'; choose from elbow, grip, shoulder, weld, wrist\n"},
    {"mimic_of_itself",
     "mimic: {wrist: {of: wrist}}\n",
     "scene.yaml: line 1, column 9: key 'mimic': error: joint 'wrist' drives itself; name another joint as its driver\n"},
    {"mimic_ring",
     "mimic: {wrist: {of: elbow}, elbow: {of: wrist}, grip: {of: elbow}}\n",
     "scene.yaml: line 1, column 29: key 'mimic': error: joints 'elbow', 'wrist' follow one another in a ring: none moves by itself; let one of them follow a joint outside of the ring, or none\n"},
    {"mimic_chain_with_zero_multiplier",
     "mimic: {wrist: {of: elbow, multiplier: 2, offset: 0.5}, elbow: {of: shoulder, multiplier: 0, offset: 0.2}}\n",
     "scene.yaml: line 1, column 57: key 'mimic': error: the multiplier of joint 'elbow' is zero: it would not move; lock it at its offset instead: locked: {elbow: 0.2}\n"
     "scene.yaml: line 1, column 9: key 'mimic': error: the multiplier of joint 'wrist' is zero: it would not move; lock it at its offset instead: locked: {wrist: 0.9}\n"},
    {"mimic_of_locked",
     "mimic: {wrist: {of: elbow}}\nlocked: [elbow]\n",
     "scene.yaml: line 1, column 17: key 'mimic': error: joint 'elbow' is locked; remove it here, or from 'locked'\n"},
    {"mimic_and_locked",
     "mimic: {wrist: {of: elbow}}\nlocked: [wrist]\n",
     "scene.yaml: line 1, column 9: key 'mimic': error: joint 'wrist' is locked; remove it here, or from 'locked'\n"},
    {"mimic_of_cut",
     "mimic: {elbow: {of: wrist}}\ncut: [hand]\n",
     "scene.yaml: line 1, column 17: key 'mimic': error: joint 'wrist' is cut off; remove it here, or remove the link it belongs to from 'cut'\n"},
    {"mimic_of_fixed",
     "mimic: {elbow: {of: weld}}\n",
     "scene.yaml: line 1, column 17: key 'mimic': error: joint 'weld' is fixed; name a joint that moves, or remove it here\n"},
    {"mimic_zero_multiplier",
     "mimic: {wrist: {of: elbow, multiplier: 0, offset: 0.2}}\n",
     "scene.yaml: line 1, column 9: key 'mimic': error: the multiplier of joint 'wrist' is zero: it would not move; lock it at its offset instead: locked: {wrist: 0.2}\n"},
    {"unknown_jacobian",
     "jacobians: [hands]\n",
     "scene.yaml: line 1, column 13: key 'jacobians': error: there is no link 'hands'; did you mean 'hand'?\n"},
    {"jacobian_without_name",
     "jacobians: [hand, [tool]]\n",
     "scene.yaml: line 1, column 19: key 'jacobians': error: an item of the list is not a name; write a list of links\n"},
    {"jacobian_of_cut",
     "jacobians: [hand]\ncut: [fore]\n",
     "scene.yaml: line 1, column 13: key 'jacobians': error: link 'hand' is cut off; remove it here, or remove the link it hangs on from 'cut'\n"},
    {"jacobian_of_fixed_base",
     "base: fixed\njacobians: [base]\n",
     "arm.urdf: link 'base': error: jacobian_base is asked for of a link that does not move: the base is fixed; name a descendant of a joint that moves, or ask for base: floating\n"},
    {"frame_of_nothing",
     "frames: {fore: []}\n",
     "scene.yaml: line 1, column 10: key 'frames': error: nothing is asked for of link 'fore'; name at least one quantity, such as pose\n"},
    {"quantity_of_a_link_asked_of_the_robot",
     "outputs: [pose]\n",
     "scene.yaml: line 1, column 11: key 'outputs': error: the quantity 'pose' is unknown; it is asked of a link: frames: {left_foot: [pose]}\n"},
    {"quantity_of_the_robot_asked_of_a_link",
     "frames: {hand: [crba]}\n",
     "scene.yaml: line 1, column 17: key 'frames': error: the quantity 'crba' of a link is unknown; it is the whole robot's: outputs: [mass_matrix]\n"},
    {"joint_named_for_a_link",
     "jacobians: [wrist]\n",
     "scene.yaml: line 1, column 13: key 'jacobians': error: there is no link 'wrist'; 'wrist' is a joint; the link that it moves is 'hand'\n"},
    {"link_named_for_a_joint",
     "armature: {hand: 1}\n",
     "scene.yaml: line 1, column 12: key 'armature': error: there is no joint 'hand'; 'hand' is a link; the joint that moves it is 'wrist'\n"},
    {"frame_of_an_unknown_part",
     "frames: {sole: {lnk: hand, at: [0.1, 0, 0]}}\n",
     "scene.yaml: line 1, column 17: key 'frames': error: 'lnk' is no part of a frame; did you mean 'link'?\n"},
    {"frame_on_an_unknown_link",
     "frames: {sole: {link: hnad, at: [0.1, 0, 0]}}\n",
     "scene.yaml: line 1, column 17: key 'frames': error: there is no link 'hnad'; did you mean 'hand'?\n"},
    {"frame_on_no_link",
     "frames: {sole: {at: [0.1, 0, 0]}}\n",
     "scene.yaml: line 1, column 10: key 'frames': error: frame 'sole' does not say which link it is on; write link: left_foot\n"},
    {"frame_on_a_list",
     "frames: {sole: {link: [hand]}}\n",
     "scene.yaml: line 1, column 23: key 'frames': error: what frame 'sole' is on is not the name of a link; write link: left_foot\n"},
    {"frame_on_another",
     "frames: {sole: {link: hand, at: [0, 0, 1]}, toe: {link: sole, at: [1, 0, 0]}}\n",
     "scene.yaml: line 1, column 51: key 'frames': error: 'sole' is a frame, and frames are on links; write link: hand, and where on it\n"},
    {"frame_at_four_numbers",
     "frames: {sole: {link: hand, at: [0, 0, 1, 0]}}\n",
     "scene.yaml: line 1, column 33: key 'frames': error: the place has neither three numbers nor six; write at: [0.1, 0, -0.02] or at: [0.1, 0, -0.02, 0, 0, 1.57], m and rad in the link's frame\n"},
    {"frame_at_words",
     "frames: {sole: {link: hand, at: [0, 0, 1, 0, 0, left]}}\n",
     "scene.yaml: line 1, column 49: key 'frames': error: 'left' is not a finite number; write a finite decimal number\n"},
    {"frame_called_as_a_link",
     "frames: {hand: {link: fore, at: [0, 0, 1]}}\n",
     "scene.yaml: line 1, column 10: key 'frames': error: frame 'hand' is called as link 'hand' is; give it a name of its own: {my_frame: {link: fore, ...}}\n"},
    {"frames_of_one_name_in_cpp",
     "frames: {a-b: {link: fore, at: [0, 0, 1], outputs: []}, a_b: {link: hand, at: [0, 0, 1], outputs: []}}\n",
     "scene.yaml: line 1, column 57: key 'frames': error: frame 'a_b' is called as frame 'a-b' is; call one of them otherwise; what stands under frames, functions may name\n"},
    {"frame_twice",
     "functions: {reach: [{sole: {link: fore, at: [0, 0, 1]}}]}\nframes: {sole: {link: fore, at: [0, 0, 1]}}\n",
     "scene.yaml: line 2, column 10: key 'frames': error: frame 'sole' is called as frame 'sole' is; call one of them otherwise; what stands under frames, functions may name\n"},
    {"frame_of_an_unknown_quantity",
     "frames: {sole: {link: hand, at: [0, 0, 1], outputs: [pos]}}\n",
     "scene.yaml: line 1, column 54: key 'frames': error: the quantity 'pos' of a link is unknown; did you mean 'pose'?\n"},
    {"frame_on_a_cut_link",
     "frames: {sole: {link: hand, at: [0, 0, 1]}}\ncut: [fore]\n",
     "scene.yaml: line 1, column 17: key 'frames': error: link 'hand' is cut off; remove it here, or remove the link it hangs on from 'cut'\n"},
    {"frame_on_the_fixed_base",
     "base: fixed\nframes: {sole: {link: base, at: [0, 0, 1], outputs: [pose]}}\n",
     "arm.urdf: frame 'sole': error: pose_sole is asked for of a link that does not move: the base is fixed; name a descendant of a joint that moves, or ask for base: floating\n"},
    {"frame_far_away",
     "frames: {sole: {link: hand, at: [0, 0, 1e70]}}\n",
     "scene.yaml: line 1, column 40: key 'frames': error: the number 1e70 of 'sole' is larger in size than 1e+60; correct the number: lengths are m, masses kg, angles rad\n"},
    {"contact_far_away",
     "outputs: [constraint_jacobian]\ncontacts: {touch: {link: hand, type: point, at: [0, 0, -1e300]}}\n",
     "scene.yaml: line 2, column 56: key 'contacts': error: the number -1e300 of 'touch' is larger in size than 1e+60; correct the number: lengths are m, masses kg, angles rad\n"},
    {"loop_far_away",
     "outputs: [constraint_jacobian]\nloops: {grip: {links: [base, hand], at: [[0, 0, 0], [0, 1e61, 1]], type: point}}\n",
     "scene.yaml: line 2, column 57: key 'loops': error: the number 1e61 of 'grip' is larger in size than 1e+60; correct the number: lengths are m, masses kg, angles rad\n"},
    {"rod_too_long",
     "outputs: [constraint_jacobian]\nloops: {rod: {links: [base, hand], type: distance, length: 1e300}}\n",
     "scene.yaml: line 2, column 60: key 'loops': error: the number 1e300 of 'rod' is larger in size than 1e+60; correct the number: lengths are m, masses kg, angles rad\n"},
    {"pitch_too_long",
     "joints: {elbow: {helical: 1e300}}\n",
     "scene.yaml: line 1, column 27: key 'joints': error: the number 1e300 of 'elbow' is larger in size than 1e+60; correct the number: lengths are m, masses kg, angles rad\n"},
    {"pitch_too_long_in_float",
     "joints: {elbow: {helical: 2e12}}\nscalar: float\n",
     "scene.yaml: line 1, column 27: key 'joints': error: the number 2e12 of 'elbow' is larger in size than 1e+12, too large for float; correct the number: lengths are m, masses kg, angles rad\n"},
    {"gravity_and_damping_too_strong",
     "gravity: [0, 0, 1e61]\ndamping: {elbow: 1, wrist: 1e62}\n",
     "scene.yaml: line 1, column 17: key 'gravity': error: the number 1e61 is larger in size than 1e+60; correct the number: lengths are m, masses kg, angles rad\nscene.yaml: line 2, column 28: key 'damping': error: the number 1e62 of 'wrist' is larger in size than 1e+60; correct the number: lengths are m, masses kg, angles rad\n"},
    {"function_of_an_unknown_frame",
     "functions: {reach: [bias, sloe]}\nframes: {sole: {link: hand, at: [0, 0, 1]}}\n",
     "scene.yaml: line 1, column 27: key 'functions': error: the quantity 'sloe' is unknown; did you mean 'sole'?\n"},
    {"function_of_a_misspelt_frames_result",
     "functions: {reach: [jacobian_mixed_sloe]}\nframes: {sole: {link: hand, at: [0, 0, 1]}}\n",
     "scene.yaml: line 1, column 21: key 'functions': error: there is no link 'sloe'; did you mean 'sole'?\n"},
    {"function_of_nothing_of_a_frame",
     "functions: {reach: [{sole: {link: hand, at: [0, 0, 1], outputs: []}}]}\n",
     "scene.yaml: line 1, column 13: key 'functions': error: function 'reach' computes nothing; name at least one quantity, such as mass_matrix\n"},
    {"wrench_on_an_unknown_frame",
     "outputs: [inverse_dynamics]\nwrenches: {sloe: link}\nframes: {sole: {link: hand, at: [0, 0, 1]}}\n",
     "scene.yaml: line 2, column 12: key 'wrenches': error: there is no link 'sloe'; did you mean 'sole'?\n"},
    {"unknown_payload",
     "payloads: [handle]\n",
     "scene.yaml: line 1, column 12: key 'payloads': error: there is no link 'handle'; did you mean 'hand'?\n"},
    {"payload_map",
     "payloads:\n  hand: 3\n",
     "scene.yaml: line 2, column 3: key 'payloads': error: the value is not a list; write a list of links\n"},
    {"payload_on_cut",
     "payloads: [hand]\ncut: [hand]\n",
     "scene.yaml: line 1, column 12: key 'payloads': error: link 'hand' is cut off; remove it here, or remove the link it hangs on from 'cut'\n"},
    {"payload_on_fixed_base",
     "base: fixed\npayloads: [base]\n",
     "arm.urdf: link 'base': error: a payload is asked for at a link that does not move; name a descendant of a joint that moves, or ask for base: floating\n"},
    {"payload_twice",
     "payloads: [hand, hand]\n",
     "scene.yaml: line 1, column 18: key 'payloads': error: 'hand' is given twice; keep one of them\n"},
    {"unknown_pushed_link",
     "wrenches: [handle]\n",
     "scene.yaml: line 1, column 12: key 'wrenches': error: there is no link 'handle'; did you mean 'hand'?\n"},
    {"wrench_along_what",
     "wrenches: {hand: base}\n",
     "scene.yaml: line 1, column 18: key 'wrenches': error: 'base' is unknown; choose from link, world\n"},
    {"wrench_twice",
     "wrenches: [hand, hand]\n",
     "scene.yaml: line 1, column 18: key 'wrenches': error: 'hand' is given twice; keep one of them\n"},
    {"wrench_on_fixed_base",
     "base: fixed\nwrenches: [base]\noutputs: inverse_dynamics\n",
     "arm.urdf: link 'base': error: a wrench is asked for on a link that does not move; name a descendant of a joint that moves, or ask for base: floating\n"},
    {"contacts_list",
     "contacts: [hand]\n",
     "scene.yaml: line 1, column 11: key 'contacts': error: the value is no map of contacts; write contacts: {left_foot: weld, toe: {link: right_foot, type: point, at: [0.1, 0, -0.02], axes: world}}\n"},
    {"contact_of_an_unknown_type",
     "contacts: {hand: wled}\n",
     "scene.yaml: line 1, column 18: key 'contacts': error: 'wled' is no type of contact; did you mean 'weld'?\n"},
    {"contact_with_an_unknown_part",
     "contacts: {tip: {lnk: hand}}\n",
     "scene.yaml: line 1, column 18: key 'contacts': error: 'lnk' is no part of a contact; did you mean 'link'?\n"},
    {"contact_along_what",
     "contacts: {hand: {axes: base}}\n",
     "scene.yaml: line 1, column 25: key 'contacts': error: 'base' is unknown; choose from world, link\n"},
    {"contact_at_two_numbers",
     "contacts: {hand: {at: [0, 1]}}\n",
     "scene.yaml: line 1, column 23: key 'contacts': error: the vector does not have three numbers; write at: [0.1, 0, -0.02], m in the link's frame\n"},
    {"contact_on_an_unknown_link",
     "contacts: {tip: {link: hnd}}\n",
     "scene.yaml: line 1, column 18: key 'contacts': error: there is no link 'hnd'; did you mean 'hand'?\n"},
    {"contact_named_like_no_link",
     "contacts: {hnd: weld}\n",
     "scene.yaml: line 1, column 12: key 'contacts': error: there is no link 'hnd'; did you mean 'hand'?\n"},
    {"contact_on_cut",
     "contacts: {hand: weld}\ncut: [hand]\n",
     "scene.yaml: line 1, column 12: key 'contacts': error: link 'hand' is cut off; remove it here, or remove the link it hangs on from 'cut'\n"},
    {"contact_given_twice",
     "contacts: {hand: weld, hand: point}\n",
     "scene.yaml: line 1, column 24: key 'contacts': error: 'hand' is given twice; keep one of them\n"},
    {"contact_on_fixed_base",
     "base: fixed\ncontacts: {base: weld}\n",
     "arm.urdf: contact 'base': error: link 'base' is welded to a fixed base: there is nothing to hold; name a descendant of a joint that moves, or ask for base: floating\n"},
    {"contact_again",
     "contacts: {hand: weld, grip: {link: hand, at: [0.1, 0, 0]}}\n",
     "arm.urdf: contact 'grip': error: it is contact 'hand' again: both weld the same body; keep one of the two\n"},
    {"point_again",
     "contacts: {hand: point, tip: {link: hand, type: point}}\n",
     "arm.urdf: contact 'tip': error: it is contact 'hand' again: both hold the same point of one body; keep one of the two\n"},
    {"contacts_of_one_name",
     "contacts: {tip-1: {link: hand, type: point, at: [1, 0, 0]}, tip.1: {link: hand, type: point}}\n",
     "scene.yaml: line 1, column 61: key 'contacts': error: two contacts would be called 'tip_1' in C++; call one of them otherwise\n"},
    {"loops_list",
     "loops: [hand]\n",
     "scene.yaml: line 1, column 8: key 'loops': error: the value is no map of loops; write loops: {rod: {links: [crank, rod], at: [[0.1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]], type: hinge}}\n"},
    {"loop_of_an_unknown_type",
     "loops: {rod: {links: [base, hand], type: hing}}\n",
     "scene.yaml: line 1, column 42: key 'loops': error: 'hing' is no type of loop; did you mean 'hinge'?\n"},
    {"loop_with_an_unknown_part",
     "loops: {rod: {link: [base, hand], type: hinge}}\n",
     "scene.yaml: line 1, column 15: key 'loops': error: 'link' is no part of a loop; did you mean 'links'?\n"},
    {"loop_of_three_links",
     "loops: {rod: {links: [base, hand, hand], type: hinge}}\n",
     "scene.yaml: line 1, column 22: key 'loops': error: what loop 'rod' holds together is not two links; write links: [crank, rod]\n"},
    {"loop_without_links",
     "loops: {rod: {type: hinge}}\n",
     "scene.yaml: line 1, column 9: key 'loops': error: loop 'rod' does not say which links it holds together; write loops: {rod: {links: [crank, rod], at: [[0.1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]], type: hinge}}\n"},
    {"loop_without_a_type",
     "loops: {rod: {links: [base, hand]}}\n",
     "scene.yaml: line 1, column 9: key 'loops': error: loop 'rod' does not say of which type it is; write loops: {rod: {links: [crank, rod], at: [[0.1, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0]], type: hinge}}\n"},
    {"loop_at_one_pose",
     "loops: {rod: {links: [base, hand], at: [[0, 0, 0]], type: hinge}}\n",
     "scene.yaml: line 1, column 40: key 'loops': error: where loop 'rod' holds is not two poses; write at: [[0.1, 0, 0, 0, 0, 0], [0, 0, 0.2, 0, 0, 1.57]], on each link x y z (m) and roll pitch yaw (rad), or x y z alone\n"},
    {"loop_at_four_numbers",
     "loops: {rod: {links: [base, hand], at: [[0, 0, 0], [1, 2, 3, 4]], type: hinge}}\n",
     "scene.yaml: line 1, column 52: key 'loops': error: a pose does not have six numbers, or three; write at: [[0.1, 0, 0, 0, 0, 0], [0, 0, 0.2, 0, 0, 1.57]], on each link x y z (m) and roll pitch yaw (rad), or x y z alone\n"},
    {"loop_of_a_length_that_is_none",
     "loops: {rod: {links: [base, hand], type: hinge, length: 0.4}}\n",
     "scene.yaml: line 1, column 9: key 'loops': error: loop 'rod' has a length and is no distance; remove length, or write type: distance\n"},
    {"loop_of_a_negative_length",
     "loops: {rod: {links: [base, hand], type: distance, length: -0.4}}\n",
     "scene.yaml: line 1, column 60: key 'loops': error: the length of loop 'rod' is not positive; give a value above zero; points that coincide are type: point\n"},
    {"loop_on_an_unknown_link",
     "loops: {rod: {links: [base, hnd], type: hinge}}\n",
     "scene.yaml: line 1, column 15: key 'loops': error: there is no link 'hnd'; did you mean 'hand'?\n"},
    {"loop_of_a_link_and_itself",
     "loops: {rod: {links: [hand, hand], type: hinge}}\n",
     "arm.urdf: loop 'rod': error: it holds link 'hand' to itself; name two links that move against each other\n"},
    {"loop_on_cut",
     "loops: {rod: {links: [base, hand], type: hinge}}\ncut: [hand]\n",
     "scene.yaml: line 1, column 15: key 'loops': error: link 'hand' is cut off; remove it here, or remove the link it hangs on from 'cut'\n"},
    {"loop_again",
     "loops: {rod: {links: [base, hand], type: hinge}, other: {links: [hand, base], type: hinge}}\n",
     "arm.urdf: loop 'other': error: it is loop 'rod' again: both hold the same frames of the same bodies; keep one of the two\n"},
    {"loops_of_one_name",
     "loops: {tip-1: {links: [base, hand], type: hinge}, tip.1: {links: [base, hand], type: point}}\n",
     "scene.yaml: line 1, column 52: key 'loops': error: two loops would be called 'tip_1' in C++; call one of them otherwise\n"},
    {"independent_no_list",
     "loops: {knee: {links: [base, hand], type: pin, independent: shoulder}}\n",
     "scene.yaml: line 1, column 61: key 'loops': error: the independent joints of loop 'knee' are no list of names; write independent: [motor], or leave it out: the loop has rows then\n"},
    {"independent_none",
     "loops: {knee: {links: [base, hand], type: pin, independent: []}}\n",
     "scene.yaml: line 1, column 61: key 'loops': error: the independent joints of loop 'knee' are no list of names; write independent: [motor], or leave it out: the loop has rows then\n"},
    {"independent_twice",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [wrist, wrist]}}\n",
     "scene.yaml: line 1, column 103: key 'loops': error: loop 'knee' names the independent joint 'wrist' twice; name it once\n"},
    {"independent_unknown",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [wirst]}}\n",
     "scene.yaml: line 1, column 82: key 'loops': error: there is no joint 'wirst'; did you mean 'wrist'?\n"},
    {"independent_locked",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [wrist]}}\nlocked: {wrist: 0}\n",
     "scene.yaml: line 1, column 82: key 'loops': error: joint 'wrist' is locked; remove it here, or from 'locked'\n"},
    {"independent_elsewhere",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [grip]}}\n",
     "arm.urdf: loop 'knee': error: joint 'grip' is named as independent, and the loop does not move it: it is not between links 'base' and 'hand'; name one of joints 'shoulder', 'elbow', 'wrist'\n"},
    {"too_few_independent",
     "loops: {knee: {links: [base, hand], type: distance, length: 0.2, independent: [shoulder]}}\n",
     "arm.urdf: loop 'knee': error: too few joints are independent: 1 row cannot tell where 2 joints are, 'elbow', 'wrist'; name 1 more of them as independent, or let the loop hold more\n"},
    {"too_many_independent",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder, wrist]}}\n",
     "arm.urdf: loop 'knee': error: too many joints are independent: 2 rows hold 1 joint, 'elbow'; name 1 fewer of 'shoulder', 'wrist', or let the loop hold less: a planar linkage takes type: pin, of two rows\n"},
    {"too_many_rows_for_independent",
     "loops: {knee: {links: [base, hand], type: hinge, independent: [shoulder]}}\n",
     "arm.urdf: loop 'knee': error: too many joints are independent: 5 rows hold 2 joints, 'elbow', 'wrist'; let the loop hold less: a planar linkage takes type: pin, of two rows\n"},
    {"loop_of_independent_joints_alone",
     "loops: {knee: {links: [base, fore], type: pin, independent: [shoulder, elbow]}}\n",
     "arm.urdf: loop 'knee': error: too many joints are independent: 2 rows have none that follows; let the loop hold less: a planar linkage takes type: pin, of two rows\n"},
    {"rows_that_do_not_tell",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0, 0, 0]], type: pin, independent: [shoulder]}}\n",
     "arm.urdf: loop 'knee': error: what it holds does not tell where joints 'elbow', 'wrist' are: rows say the same, or not all of these joints move them; choose a type whose rows differ (a planar linkage takes pin, across the joints' axes), or other independent joints\n"},
    {"loop_that_cannot_close",
     "loops: {knee: {links: [base, hand], at: [[5, 0, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\n",
     "arm.urdf: loop 'knee': error: no position of its joints was found that closes it: 4.6 are left at best; correct 'at', which says where the links are held together, or the length\n"},
    {"independent_beside_contacts",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\ncontacts: {finger: point}\n",
     "scene.yaml: line 1, column 82: key 'loops': error: loop 'knee' is embedded, and contact 'finger' has rows: both together are not computed; leave 'independent' out of loop 'knee': it has rows beside those of contacts then\n"},
    {"independent_beside_rows",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}, tie: {links: [base, finger], type: distance, length: 0.3}}\n",
     "scene.yaml: line 1, column 82: key 'loops': error: loop 'knee' is embedded, and loop 'tie' has rows: both together are not computed; give all loops independent joints, or none\n"},
    {"independent_and_parts",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\noutputs: [{mass_matrix: {joints: [shoulder]}}]\n",
     "part of mass_matrix: error: loop 'knee' is embedded, and results of it are whole; ask for the whole here, or leave 'independent' out of the loop\n"},
    {"independent_and_derivatives",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\noutputs: [forward_dynamics_dq]\n",
     "scene.yaml: line 2, column 11: key 'outputs': error: forward_dynamics_dq is asked for, and loop 'knee' is embedded: it is not computed of independent coordinates; leave 'independent' out of all loops and ask for constrained_forward_dynamics and its derivatives\n"},
    {"independent_and_forces",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\nfunctions: {hold: [constraint_forces]}\n",
     "scene.yaml: line 2, column 20: key 'functions': error: constraint_forces is asked for, and loop 'knee' is embedded: it is not computed of independent coordinates; leave 'independent' out of all loops: they have rows and forces then\n"},
    {"independent_in_batches",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\nbatch: true\n",
     "scene.yaml: line 2, column 1: key 'batch': error: loop 'knee' is embedded, and batches are of robots without; leave batch out, or 'independent' of all loops\n"},
    {"independent_in_tasks",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\nparallel: tasks\n",
     "scene.yaml: line 2, column 1: key 'parallel': error: loop 'knee' is embedded, and task graphs are of robots without; leave parallel: tasks out\n"},
    {"independent_by_articulated_bodies",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\noutputs: [forward_dynamics]\nforward_dynamics: articulated_bodies\n",
     "scene.yaml: line 3, column 1: key 'forward_dynamics': error: loop 'knee' is embedded: what is solved with M is solved by factorization; leave the key out, or write forward_dynamics: factorization\n"},
    {"independent_beside_mimic",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\nmimic: {wrist: {of: elbow}}\n",
     "arm.urdf: loop 'knee': error: joint 'wrist' between its links is a mimic joint, of 'elbow'; remove the mimic relation, or leave 'independent' out of the loop: it has rows then\n"},
    {"independent_beside_elastic",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\nelastic: {elbow: {k: 10, inertia: 0.1}}\n",
     "arm.urdf: loop 'knee': error: joint 'elbow' between its links is elastic; make it rigid, or leave 'independent' out of the loop: it has rows then\n"},
    {"independent_beside_ball",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\njoints: {wrist: spherical}\n",
     "arm.urdf: loop 'knee': error: joint 'wrist' between its links has a quaternion, and can neither follow nor be followed; make it universal, or leave 'independent' out of the loop: it has rows then\n"},
    {"function_called_close_loops",
     "loops: {knee: {links: [base, hand], at: [[0.1, 0.1, 0], [0.1, 0, 0]], type: pin, independent: [shoulder]}}\nfunctions: {close_loops: [mass_matrix]}\n",
     "scene.yaml: line 2, column 13: key 'functions': error: the generated code has another 'close_loops'; call the function 'close_loops' otherwise\n"},
    {"rows_without_contacts",
     "outputs: [mass_matrix, constraint_jacobian]\n",
     "scene.yaml: line 1, column 24: key 'outputs': error: constraint_jacobian is asked for, and there is neither a contact nor a loop; say where the robot is held: contacts: {left_foot: weld}, or which links hold each other: loops\n"},
    {"function_of_rows_without_contacts",
     "functions: {stand: [constrained_forward_dynamics]}\n",
     "scene.yaml: line 1, column 21: key 'functions': error: constrained_forward_dynamics is asked for, and there is neither a contact nor a loop; say where the robot is held: contacts: {left_foot: weld}, or which links hold each other: loops\n"},
    {"negative_armature",
     "armature: {elbow: -1}\n",
     "scene.yaml: line 1, column 19: key 'armature': error: the armature of joint 'elbow' is negative; give a value of zero or more\n"},
    {"negative_damping",
     "damping: {elbow: -1}\n",
     "scene.yaml: line 1, column 18: key 'damping': error: the damping of joint 'elbow' is negative; give a value of zero or more\n"},
    {"negative_friction",
     "friction: {elbow: -1}\n",
     "scene.yaml: line 1, column 19: key 'friction': error: the friction of joint 'elbow' is negative; give a value of zero or more\n"},
    {"negative_stiffness",
     "stiffness: {elbow: {k: -1, rest: 0}}\n",
     "scene.yaml: line 1, column 24: key 'stiffness': error: the stiffness of joint 'elbow' is negative; give a value of zero or more\n"},
    {"infinite_stiffness",
     "stiffness: {elbow: {k: inf}}\n",
     "scene.yaml: line 1, column 24: key 'stiffness': error: 'inf' is not a finite number; write a finite decimal number\n"},
    {"stiffness_without_k",
     "stiffness: {elbow: {rest: 0.1}}\n",
     "scene.yaml: line 1, column 13: key 'stiffness': error: the spring of 'elbow' has no k; write stiffness: {joint: {k: 100, rest: 0}}, or {joint: 100} for a spring at rest at zero\n"},
    {"stiffness_part",
     "stiffness: {elbow: {k: 1, rset: 0.1}}\n",
     "scene.yaml: line 1, column 27: key 'stiffness': error: 'rset' is no part of a spring; did you mean 'rest'?\n"},
    {"stiffness_list",
     "stiffness: [elbow]\n",
     "scene.yaml: line 1, column 12: key 'stiffness': error: the value is not a map; write stiffness: {joint: {k: 100, rest: 0}}, or {joint: 100} for a spring at rest at zero\n"},
    {"stiffness_of_a_list",
     "stiffness: {elbow: [1, 0]}\n",
     "scene.yaml: line 1, column 20: key 'stiffness': error: the spring of 'elbow' is no map; write stiffness: {joint: {k: 100, rest: 0}}, or {joint: 100} for a spring at rest at zero\n"},
    {"stiffness_of_unknown",
     "stiffness: {elbwo: 1}\n",
     "scene.yaml: line 1, column 13: key 'stiffness': error: there is no joint 'elbwo'; did you mean 'elbow'?\n"},
    {"stiffness_of_fixed",
     "stiffness: {weld: 1}\n",
     "scene.yaml: line 1, column 13: key 'stiffness': error: joint 'weld' is fixed; name a joint that moves, or remove it here\n"},
    {"stiffness_of_locked",
     "stiffness: {elbow: 1}\nlocked: [elbow]\n",
     "scene.yaml: line 1, column 13: key 'stiffness': error: joint 'elbow' is locked; remove it here, or from 'locked'\n"},
    {"stiffness_of_driven",
     "stiffness: {wrist: 1}\nmimic: {wrist: {of: elbow}}\n",
     "scene.yaml: line 1, column 13: key 'stiffness': error: joint 'wrist' mimics 'elbow'; give the spring to 'elbow'\n"},
    {"joints_unknown_kind",
     "joints: {elbow: ball}\n",
     "scene.yaml: line 1, column 17: key 'joints': error: 'ball' is unknown; choose from helical, universal, planar, spherical, floating\n"},
    {"joints_without_pitch",
     "joints: {elbow: helical}\n",
     "scene.yaml: line 1, column 17: key 'joints': error: joint 'elbow' is helical, which needs a pitch in m per turn; write joints: {lead: {helical: 0.005}, wrist: {universal: [0, 1, 0]}, plate: planar}\n"},
    {"joints_value_too_many",
     "joints: {elbow: {planar: 1}}\n",
     "scene.yaml: line 1, column 18: key 'joints': error: 'planar' takes no value; write joints: {lead: {helical: 0.005}, wrist: {universal: [0, 1, 0]}, plate: planar}\n"},
    {"joints_zero_axis",
     "joints: {elbow: {universal: [0, 0, 0]}}\n",
     "scene.yaml: line 1, column 18: key 'joints': error: the second axis of joint 'elbow' is zero; write joints: {lead: {helical: 0.005}, wrist: {universal: [0, 1, 0]}, plate: planar}\n"},
    {"joints_list",
     "joints: [elbow]\n",
     "scene.yaml: line 1, column 9: key 'joints': error: the value is no map from joints to what they are; write joints: {lead: {helical: 0.005}, wrist: {universal: [0, 1, 0]}, plate: planar}\n"},
    {"joints_neither",
     "joints: {elbow: [helical]}\n",
     "scene.yaml: line 1, column 17: key 'joints': error: what is said of joint 'elbow' is neither a word nor a map of one; write joints: {lead: {helical: 0.005}, wrist: {universal: [0, 1, 0]}, plate: planar}\n"},
    {"joints_unknown_joint",
     "joints: {nobody: planar}\n",
     "scene.yaml: line 1, column 10: key 'joints': error: there is no joint 'nobody'; choose from elbow, grip, shoulder, weld, wrist\n"},
    {"locked_ball",
     "joints: {elbow: spherical}\nlocked: {elbow: 0.2}\n",
     "scene.yaml: line 2, column 10: key 'locked': error: joint 'elbow' has 3 coordinates; lock it at zero, and say in the URDF's <origin> where that is\n"},
    {"mimic_of_ball",
     "joints: {elbow: spherical}\nmimic: {wrist: {of: elbow}}\n",
     "scene.yaml: line 2, column 17: key 'mimic': error: joint 'elbow' has 3 coordinates; name a joint of one coordinate, or remove it here\n"},
    {"stiffness_of_plane",
     "joints: {elbow: planar}\nstiffness: {elbow: 3}\n",
     "scene.yaml: line 2, column 13: key 'stiffness': error: joint 'elbow' has 3 coordinates; name a joint of one coordinate, or remove it here\n"},
    {"elastic_plane",
     "joints: {elbow: planar}\nelastic: {elbow: {k: 3, inertia: 1}}\n",
     "scene.yaml: line 2, column 11: key 'elastic': error: joint 'elbow' has 3 coordinates; name a joint of one coordinate, or remove it here\n"},
    {"elastic_without_inertia",
     "elastic: {elbow: {k: 10}}\n",
     "scene.yaml: line 1, column 11: key 'elastic': error: the spring of 'elbow' has no inertia; write elastic: {joint: {k: 1000, inertia: 0.3, damping: 1}}\n"},
    {"elastic_without_k",
     "elastic: {elbow: {inertia: 1}}\n",
     "scene.yaml: line 1, column 11: key 'elastic': error: the spring of 'elbow' has no k; write elastic: {joint: {k: 1000, inertia: 0.3, damping: 1}}\n"},
    {"elastic_number",
     "elastic: {elbow: 10}\n",
     "scene.yaml: line 1, column 18: key 'elastic': error: the spring of 'elbow' is no map; write elastic: {joint: {k: 1000, inertia: 0.3, damping: 1}}\n"},
    {"elastic_list",
     "elastic: [elbow]\n",
     "scene.yaml: line 1, column 10: key 'elastic': error: the value is not a map; write elastic: {joint: {k: 1000, inertia: 0.3, damping: 1}}\n"},
    {"elastic_part",
     "elastic: {elbow: {k: 10, inertia: 1, rest: 0}}\n",
     "scene.yaml: line 1, column 38: key 'elastic': error: 'rest' is no part of a spring; choose from k, inertia, damping\n"},
    {"frame_without_a_name",
     "frames: {'': {link: fore}}\n",
     "scene.yaml: line 1, column 1: key 'frames': error: a frame has an empty name; give it one\n"},
    {"loop_without_a_name",
     "loops: {'': {links: [fore, base], at: [[0, 0, 0], [0, 0, 0]], type: point}}\n",
     "scene.yaml: line 1, column 1: key 'loops': error: a loop has an empty name; give it one\n"},
    {"merge_key",
     "locked: {<<: {elbow: 1}}\n",
     "scene.yaml: line 1, column 10: error: merge keys (<<) are not read; write the entries out; aliases of whole values are read\n"},
    {"elastic_without_stiffness",
     "elastic: {elbow: {k: 0, inertia: 1}}\n",
     "scene.yaml: line 1, column 22: key 'elastic': error: the k of elastic joint 'elbow' is not positive; give a value above zero; a joint left out is rigid\n"},
    {"elastic_with_negative_inertia",
     "elastic: {elbow: {k: 1, inertia: -1}}\n",
     "scene.yaml: line 1, column 34: key 'elastic': error: the inertia of elastic joint 'elbow' is not positive; give a value above zero; a joint left out is rigid\n"},
    {"elastic_with_negative_damping",
     "elastic: {elbow: {k: 1, inertia: 1, damping: -2}}\n",
     "scene.yaml: line 1, column 46: key 'elastic': error: the damping of elastic joint 'elbow' is negative; give a value of zero or more\n"},
    {"elastic_with_armature",
     "elastic: {elbow: {k: 1, inertia: 1}}\narmature: {elbow: 1}\n",
     "scene.yaml: line 2, column 12: key 'armature': error: joint 'elbow' is elastic; remove it here: the inertia in 'elastic' is that of the motor\n"},
    {"spring_of_elastic",
     "elastic: {elbow: {k: 1, inertia: 1}}\ndamping: {elbow_spring: 1}\n",
     "scene.yaml: line 2, column 11: key 'damping': error: 'elbow_spring' is a part of elastic joint 'elbow'; what belongs to it stands under elastic, and what belongs to the motor under 'elbow'\n"},
    {"elastic_of_locked",
     "elastic: {elbow: {k: 1, inertia: 1}}\nlocked: [elbow]\n",
     "scene.yaml: line 1, column 11: key 'elastic': error: joint 'elbow' is locked; remove it here, or from 'locked'\n"},
    {"armature_of_locked",
     "armature: {elbow: 1}\nlocked: [elbow]\n",
     "scene.yaml: line 1, column 12: key 'armature': error: joint 'elbow' is locked; remove it here, or from 'locked'\n"},
    {"damping_of_fixed",
     "damping: {weld: 1}\n",
     "scene.yaml: line 1, column 11: key 'damping': error: joint 'weld' is fixed; name a joint that moves, or remove it here\n"},
    {"friction_of_unknown",
     "friction: {elbwo: 1}\n",
     "scene.yaml: line 1, column 12: key 'friction': error: there is no joint 'elbwo'; did you mean 'elbow'?\n"},
    {"damping_word",
     "damping: yes\n",
     "scene.yaml: line 1, column 10: key 'damping': error: the value is not a map; write damping: {joint: value}, or urdf to take the URDF's values\n"},
    {"friction_list",
     "friction: [elbow]\n",
     "scene.yaml: line 1, column 11: key 'friction': error: the value is not a map; write friction: {joint: value}, or urdf to take the URDF's values\n"},
    {"armature_word",
     "armature: urdf\n",
     "scene.yaml: line 1, column 11: key 'armature': error: the value is not a map; write armature: {joint: value}\n"},
    {"armature_value",
     "armature: {elbow: big}\n",
     "scene.yaml: line 1, column 19: key 'armature': error: 'big' is not a finite number; write a finite decimal number\n"},
    {"massless_word",
     "massless: drop\n",
     "scene.yaml: line 1, column 11: key 'massless': error: 'drop' is unknown; choose from keep, lock\n"},
    {"inertia_word",
     "inertia: fix\n",
     "scene.yaml: line 1, column 10: key 'inertia': error: 'fix' is unknown; choose from refuse, accept, repair\n"},
    {"rates_zero_word",
     "rates_zero: maybe\n",
     "scene.yaml: line 1, column 13: key 'rates_zero': error: 'maybe' is unknown; choose from true, false\n"},
    {"rates_zero_and_coriolis",
     "rates_zero: true\noutputs: [mass_matrix, coriolis_matrix]\n",
     "scene.yaml: line 2, column 1: key 'outputs': error: coriolis_matrix is zero when rates_zero is set; remove one of the two; bias then knows no velocities, and may stay\n"},
    {"rates_zero_list",
     "rates_zero: []\n",
     "scene.yaml: line 1, column 13: key 'rates_zero': error: the value is unknown; choose from true, false\n"},
    {"solver_word",
     "forward_dynamics: cholesky\n",
     "scene.yaml: line 1, column 19: key 'forward_dynamics': error: 'cholesky' is unknown; choose from articulated_bodies, factorization\n"},
    {"scalar_value",
     "scalar: half\n",
     "scene.yaml: line 1, column 9: key 'scalar': error: 'half' is unknown; choose from double, float\n"},
    {"parallel_value",
     "parallel: threads\n",
     "scene.yaml: line 1, column 11: key 'parallel': error: 'threads' is unknown; choose from serial, tasks, auto\n"},
    {"batch_value",
     "batch: 4096\n",
     "scene.yaml: line 1, column 8: key 'batch': error: '4096' is unknown; choose from true, false\n"},
    {"rollouts_of_no_list",
     "rollouts: {linearly_implicit: true}\n",
     "scene.yaml: line 1, column 11: key 'rollouts': error: the value is not a list; write a list of what rollouts shall know, such as [linearly_implicit]\n"},
    {"rollouts_by_an_unknown_method",
     "batch: true\noutputs: [forward_dynamics]\nrollouts: [linear_implicit]\n",
     "scene.yaml: line 3, column 12: key 'rollouts': error: rollouts know no 'linear_implicit'; did you mean 'linearly_implicit'?\n"},
    {"rollouts_by_a_usual_method",
     "batch: true\noutputs: [forward_dynamics]\nrollouts: [rk4, linearly_implicit]\n",
     "scene.yaml: line 3, column 12: key 'rollouts': error: every rollout has 'rk4'; leave it out\n"},
    {"rollouts_without_batches",
     "outputs: [forward_dynamics]\nrollouts: [linearly_implicit]\n",
     "scene.yaml: line 2, column 12: key 'rollouts': error: rollouts are of batches, which are not asked for; write batch: true, and leave out what says otherwise (--batch false; dalembert_add_robot() without BATCH)\n"},
    {"rollouts_of_what_does_not_move",
     "batch: true\noutputs: [mass_matrix]\nrollouts: [linearly_implicit]\n",
     "scene.yaml: line 3, column 12: key 'rollouts': error: no function tells how the robot moves; ask for forward_dynamics\n"},
    {"rollouts_of_what_is_held",
     "batch: true\noutputs: [forward_dynamics, constrained_forward_dynamics]\ncontacts: {hand: point}\nrollouts: [linearly_implicit]\n",
     "scene.yaml: line 4, column 12: key 'rollouts': error: contact 'hand' holds the robot, and linearly implicit steps are of robots that nothing holds; leave linearly_implicit out, or the contacts and loops\n"},
    {"rollouts_with_impacts_of_what_nothing_holds",
     "batch: true\noutputs: [forward_dynamics]\nrollouts: [impacts]\n",
     "scene.yaml: line 3, column 12: key 'rollouts': error: no function tells how the robot moves where contacts and loops hold it; ask for constrained_forward_dynamics\n"
     "scene.yaml: line 3, column 12: key 'rollouts': error: no function tells what an impact does; ask for impact, beside constrained_forward_dynamics\n"},
    {"rollouts_with_impacts_of_which_nothing_tells",
     "batch: true\noutputs: [constrained_forward_dynamics]\ncontacts: {hand: point}\nrollouts: [impacts]\n",
     "scene.yaml: line 4, column 12: key 'rollouts': error: no function tells what an impact does; ask for impact, beside constrained_forward_dynamics\n"},
    {"rollouts_at_rest",
     "batch: true\noutputs: [forward_dynamics]\nrates_zero: true\nrollouts: [linearly_implicit]\n",
     "scene.yaml: line 4, column 12: key 'rollouts': error: velocities are zero, and nothing moves; leave rates_zero out, or linearly_implicit\n"},
    {"impacts_at_rest",
     "batch: true\noutputs: [constrained_forward_dynamics, impact]\ncontacts: {hand: point}\nrates_zero: true\nrollouts: [impacts]\n",
     "scene.yaml: line 5, column 12: key 'rollouts': error: velocities are zero, and nothing moves; leave rates_zero out, or impacts\n"},
    {"everything_locked",
     "base: fixed\nlocked: [shoulder, elbow, wrist, grip]\n",
     "arm.urdf: robot 'arm': error: no joint is left to move and the base is fixed; unlock a joint, or ask for --base floating\n"},
    {"key_twice",
     "base: fixed\nbase: floating\n",
     "scene.yaml: line 2, column 1: key 'base': error: the key is given twice; keep one of them\n"},
    {"not_yaml",
     "base: fixed\n  gravity: [\n",
     "scene.yaml: line 2, column 10: error: this is not YAML: illegal map value; share/doc/dalembert/docs/scene.md shows how a scene is written\n"},
    {"not_a_map",
     "- base\n",
     "scene.yaml: line 1, column 1: error: a scene is a map of keys to values; write lines such as 'base: fixed'\n"},
};
// clang-format on

class Scene : public testing::TestWithParam<Case> {
 protected:
  Scene() {
    write_text(folder_.path() + "/arm.urdf", text_of(arm));
    write_text(folder_.path() + "/scene.yaml", GetParam().scene);
  }
  TemporaryFolder folder_;
};

TEST_P(Scene, IsRefusedWithPlaceAndRemedyAndNothingIsWritten) {
  const Outcome run = run_dalembert({"generate", "arm.urdf", "--scene", "scene.yaml", "-o", "out"}, folder_.path());
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.err, GetParam().messages);
  EXPECT_EQ(run.out, "");
  EXPECT_FALSE(std::filesystem::exists(folder_.path() + "/out"));
}

INSTANTIATE_TEST_SUITE_P(Defects, Scene, testing::ValuesIn(defects),
                         [](const auto& info) { return std::string(info.param.name); });

// With a floating base unless the options say otherwise: where nobody says, that is a notice.
Outcome info(std::vector<std::string> options) {
  const auto given = [&](const char* option) { return std::find(options.begin(), options.end(), option) != options.end(); };
  if (!given("--base") && !given("--scene")) options.insert(options.end(), {"--base", "floating"});
  options.insert(options.begin(), {"info", arm});
  return run_dalembert(options, ERROR_ROBOTS);
}

std::string nq_and_nv(const Outcome& run) {
  const size_t begin = run.out.find("nq = ");
  return begin == run.out.npos ? run.err : run.out.substr(begin, run.out.find('\n', begin) - begin);
}

TEST(SceneOptions, EveryKeyIsAnOptionOfTheSameName) {
  EXPECT_EQ(nq_and_nv(info({})), "nq = 11, nv = 10");
  EXPECT_EQ(nq_and_nv(info({"--base", "fixed"})), "nq = 4, nv = 4");
  EXPECT_EQ(nq_and_nv(info({"--locked", "elbow=0.3,wrist=0"})), "nq = 9, nv = 8");
  EXPECT_EQ(nq_and_nv(info({"--locked", "elbow,wrist"})), "nq = 9, nv = 8");
  EXPECT_EQ(nq_and_nv(info({"--locked", "{elbow: 0.3}"})), "nq = 10, nv = 9");
  EXPECT_EQ(nq_and_nv(info({"--cut", "fore"})), "nq = 8, nv = 7");
  EXPECT_EQ(nq_and_nv(info({"--mimic", "{wrist: {of: elbow, multiplier: -1, offset: 0.1}}"})), "nq = 10, nv = 9");
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"--gravity", "0,0,-1.62"},
                                             {"--gravity", "-9.81,0,0"},
                                             {"--gravity", "none"},
                                             {"--gravity", "run_time"},
                                             {"--gravity", "run_time=0,0,-9.81"},
                                             {"--outputs", "gravity"},
                                             {"--outputs", "bias,wrench_influence"},
                                             {"--jacobians", "hand,tool"},
                                             {"--payloads", "hand"},
                                             {"--armature", "elbow=0.1"},
                                             {"--damping", "urdf"},
                                             {"--friction", "elbow=1,wrist=2"},
                                             {"--stiffness", "elbow=1,wrist=2"},
                                             {"--stiffness", "{elbow: {k: 1, rest: 0.2}}"},
                                             {"--outputs", "forward_dynamics", "--forward_dynamics", "factorization"},
                                             {"--rates_zero", "true"},
                                             {"--scalar", "float"},
                                             {"--parallel", "tasks"}})
    EXPECT_EQ(info(options).status, 0) << options[0] << ' ' << options[1] << info(options).err;
}

TEST(SceneOptions, OptionsOverrideTheFile) {
  const TemporaryFolder folder;
  const std::string scene = folder.path() + "/scene.yaml";
  write_text(scene, "base: fixed\nlocked: {elbow: 0}\n");
  EXPECT_EQ(nq_and_nv(info({"--scene", scene})), "nq = 3, nv = 3");
  EXPECT_EQ(nq_and_nv(info({"--scene", scene, "--base", "floating"})), "nq = 10, nv = 9");
  EXPECT_EQ(nq_and_nv(info({"--scene", scene, "--locked", ""})), "nq = 4, nv = 4");
}

TEST(SceneOptions, ComplaintsNameTheOption) {
  const auto complaint = [](std::vector<std::string> options) {
    const Outcome run = info(std::move(options));
    EXPECT_EQ(run.status, 2);
    return run.err;
  };
  EXPECT_EQ(complaint({"--base", "hanging"}), "option --base: error: 'hanging' is unknown; choose from fixed, floating\n");
  EXPECT_EQ(complaint({"--cut", "hnd"}), "option --cut: error: there is no link 'hnd'; did you mean 'hand'?\n");
  EXPECT_EQ(complaint({"--locked", "elbow=1,elbow=2"}), "option --locked: error: 'elbow' is given twice; keep one of them\n");
  EXPECT_EQ(complaint({"--outputs", ""}),
            "option --outputs: error: no output is asked for; name at least one quantity, such as mass_matrix\n");
  EXPECT_EQ(complaint({"--mimic", "{elbow: {"}),
            "option --mimic: error: the value is not YAML: end of map flow not found; share/doc/dalembert/docs/scene.md shows "
            "how it is written\n");
}

// As URDFs exported with namespaces have them.
TEST(SceneNames, MayHoldSlashes) {
  const TemporaryFolder folder;
  std::string urdf = text_of(arm);
  const std::string hand = "\"hand\"";
  for (size_t at = urdf.find(hand); at != urdf.npos; at = urdf.find(hand, at)) urdf.replace(at, hand.size(), "\"fore/pose\"");
  write_text(folder.path() + "/arm.urdf", urdf);
  const auto info = [&](const std::string& frames) {
    return run_dalembert({"info", "arm.urdf", "--base", "floating", "--frames", frames}, folder.path());
  };
  const Outcome run = info("{fore: [pose], fore/pose: [twist]}");
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
  EXPECT_EQ(info("{fore/pose: [twist], fore/pose: [pose]}").err,
            "option --frames: error: 'fore/pose' is given twice; keep one of them\n");
}

TEST(SceneOptions, KeysThatNoOutputHasToDoWithAreToldOf) {
  const auto idle = [](const std::string& key, const std::string& value, const std::string& outputs) {
    const std::string said = info({"--" + key, value, "--outputs", outputs}).err;
    const std::string warning = "scene key '" + key + "': warning: ";
    EXPECT_TRUE(said.empty() || (said.rfind(warning, 0) == 0 && std::count(said.begin(), said.end(), '\n') == 1)) << said;
    return !said.empty();
  };
  EXPECT_TRUE(idle("coriolis", "christoffel", "bias"));
  EXPECT_FALSE(idle("coriolis", "christoffel", "coriolis_matrix"));
  for (const std::string loss : {"damping", "friction"}) {
    EXPECT_TRUE(idle(loss, "elbow=1", "mass_matrix,gravity,potential_energy")) << loss;
    for (const std::string output : {"bias", "inverse_dynamics", "forward_dynamics_dq"})
      EXPECT_FALSE(idle(loss, "elbow=1", "gravity," + output)) << loss << ", " << output;
  }
  EXPECT_TRUE(idle("stiffness", "elbow=1", "mass_matrix"));
  EXPECT_FALSE(idle("stiffness", "elbow=1", "potential_energy"));
  for (const std::string key : {"friction", "stiffness"})  // of which forces do not change with velocities
    EXPECT_TRUE(idle(key, "elbow=1", "inverse_dynamics_dv")) << key;
  EXPECT_FALSE(idle("damping", "elbow=1", "inverse_dynamics_dv"));
  EXPECT_TRUE(idle("rates_zero", "true", "bias,kinetic_energy"));
  EXPECT_FALSE(idle("rates_zero", "true", "bias,mass_matrix"));
  const auto at_rest = [](const char* output) {
    return info({"--rates_zero", "true", "--damping", "elbow=1", "--outputs", output}).err;
  };
  EXPECT_EQ(at_rest("inverse_dynamics"),
            "scene key 'damping': warning: no output depends on damping; leave it out, or rates_zero\n");
  EXPECT_EQ(at_rest("inverse_dynamics_dv"), "");
  EXPECT_TRUE(idle("armature", "elbow=1", "gravity,coriolis_matrix,bias,center_of_mass,inverse_dynamics_dq"));
  for (const std::string output : {"mass_matrix", "kinetic_energy", "inverse_mass_matrix", "inverse_dynamics"})
    EXPECT_FALSE(idle("armature", "elbow=1", output)) << output;
  EXPECT_TRUE(idle("gravity", "run_time", "mass_matrix,kinetic_energy"));
  for (const std::string output : {"gravity", "bias", "potential_energy", "regressor", "forward_dynamics"})
    EXPECT_FALSE(idle("gravity", "run_time", output)) << output;
  const std::string sole = "{sole: {link: hand, at: [0, 0, 1], outputs: []}}";
  EXPECT_TRUE(idle("frames", sole, "bias"));
  EXPECT_EQ(info({"--frames", sole, "--functions", "reach=bias,sole"}).err, "");
  EXPECT_EQ(info({"--frames", sole, "--jacobians", "sole"}).err, "");
  EXPECT_TRUE(idle("payloads", "hand", "wrench_influence"));
  EXPECT_FALSE(idle("payloads", "hand", "mass_matrix"));

  const std::string wrenches =
      "scene key 'wrenches': warning: no output depends on the wrenches; ask for inverse_dynamics, "
      "forward_dynamics or their derivatives\n";
  EXPECT_EQ(info({"--wrenches", "hand", "--outputs", "bias"}).err, wrenches);
  EXPECT_EQ(info({"--wrenches", "hand", "--outputs", "regressor,inverse_dynamics_dv"}).err, wrenches);
  EXPECT_EQ(info({"--wrenches", "hand", "--outputs", "inverse_dynamics"}).err, "");
  // Pushing changes accelerations, not how they change with velocities.
  EXPECT_EQ(info({"--wrenches", "hand", "--outputs", "bias", "--functions", "{f: [forward_dynamics_dv]}"}).err, wrenches);
  EXPECT_EQ(info({"--wrenches", "hand", "--outputs", "bias", "--functions", "{f: [forward_dynamics_dq]}"}).err, "");
  EXPECT_EQ(
      info({"--forward_dynamics", "factorization"}).err,
      "scene key 'forward_dynamics': warning: no output is solved for with M; ask for forward_dynamics, inverse_mass_matrix "
      "or mass_matrix_factor\n");
  EXPECT_EQ(info({"--forward_dynamics", "factorization", "--outputs", "inverse_mass_matrix"}).err, "");
  EXPECT_EQ(info({"--forward_dynamics", "articulated_bodies", "--outputs", "forward_dynamics"}).err, "");
  EXPECT_EQ(
      info({"--forward_dynamics", "articulated_bodies", "--outputs", "forward_dynamics", "--mimic", "{wrist: {of: elbow}}"})
          .err,
      "scene key 'forward_dynamics': warning: mimic joints are solved for by factorization all the "
      "same; leave the key out, or the mimic relations\n");
}

TEST(SceneOptions, ContactsThatNothingDependsOnAreNamedWithAllThatDoes) {
  EXPECT_EQ(info({"--contacts", "hand=weld", "--outputs", "bias"}).err,
            "scene key 'contacts': warning: no output depends on the contacts and loops; ask for constraint_jacobian, "
            "constraint_bias, delassus_matrix, impact, constrained_forward_dynamics, constraint_forces, "
            "constrained_inverse_dynamics or inverse_constraint_forces\n");
}

TEST(SceneOptions, WhereEveryJointHasAMotorContactsBearNothing) {
  const auto said = [](const char* base, std::vector<std::string> options) {
    options.insert(options.end(), {"--base", base, "--contacts", "hand=point", "--outputs", "constrained_inverse_dynamics"});
    return info(std::move(options)).err;
  };
  EXPECT_EQ(
      said("fixed", {}),
      "scene key 'passive': notice: the base is fixed and every joint has a motor: in constrained inverse dynamics contacts "
      "and loops bear nothing, and their forces are zero; name the joints without a motor, or ask for inverse_dynamics, "
      "which is the same\n");
  EXPECT_EQ(said("fixed", {"--passive", "elbow"}), "");
  EXPECT_EQ(said("floating", {}), "");
}

TEST(SceneOptions, ADistanceTakesNoAngles) {
  const auto said = [](const std::string& at) {
    return info({"--loops", "{rod: {links: [base, hand], type: distance, at: " + at + "}}", "--outputs", "constraint_forces"})
        .err;
  };
  EXPECT_EQ(said("[[0, 0, 1], [0, 0, 0, 0, 1.57, 0]]"),
            "option --loops: warning: roll pitch yaw of loop 'rod' are left out: a distance is between two points; write x y z "
            "alone, or another type\n");
  EXPECT_EQ(said("[[0, 0, 1, 0, 0, 0], [0, 0, 0]]"), "");
}

TEST(SceneOptions, InfoSaysWhoseRowsAreWhose) {
  const auto told = [](const std::vector<std::string>& options) {
    const std::string out = info(options).out;
    const size_t begin = out.find("contacts and loops (");
    return begin == out.npos ? "" : out.substr(begin, out.find("\n\n", begin) + 1 - begin);
  };
  EXPECT_EQ(told({"--contacts", "{toe: {link: sole, type: point}, hand: weld}", "--frames",
                  "{sole: {link: finger, at: [0, 0, 1], outputs: []}}", "--loops",
                  "{rod: {links: [tool, hand], type: distance, length: 1}, pair: {links: [base, finger], type: pin}}",
                  "--outputs", "constraint_jacobian"}),
            "contacts and loops (name: type, link, rows of the constraints):\n"
            "  toe: point, frame sole, rows 0 to 2\n"
            "  hand: weld, link hand, rows 3 to 8\n"
            "  rod: distance, link tool and link hand, row 9\n"
            "  pair: pin, link base and link finger, rows 10 to 11\n");
  EXPECT_EQ(told({}), "");
  const std::string json =
      info({"--json", "--contacts", "{toe: {link: finger, type: point}, hand: weld}", "--outputs", "constraint_jacobian"}).out;
  EXPECT_NE(json.find("\"hand\": {\"type\": \"weld\", \"of\": \"link hand\", \"first_row\": 3, \"rows\": 6}"), json.npos)
      << json;
  EXPECT_EQ(info({"--json"}).out.find("\"constraints\""), std::string::npos);
}

TEST(SceneOptions, OfAKeyGivenTwiceTheLargeNumbersAreTheOptions) {
  const TemporaryFolder folder;
  const std::string scene = folder.path() + "/scene.yaml";
  write_text(scene, "locked: {elbow: 1e300}\nscalar: float\n");
  EXPECT_EQ(info({"--scene", scene, "--base", "fixed", "--locked", "elbow=1"}).err, "");
  EXPECT_EQ(info({"--scene", scene, "--locked", "elbow=1e13"}).err,
            "option --locked: error: the number 1e13 of 'elbow' is larger in size than 1e+12, too large for float; correct the "
            "number: lengths are m, masses kg, angles rad\n");
  EXPECT_EQ(info({"--scene", scene, "--base", "fixed", "--locked", "elbow=1e13", "--scalar", "double"}).err, "");
}

TEST(SceneOptions, WhatTheUrdfDoesNotHaveIsNotTakenInSilence) {
  for (const std::string key : {"damping", "friction", "mimic"})
    EXPECT_EQ(info({"--" + key, "urdf"}).err, "option --" + key + ": warning: no joint that moves has a " + key +
                                                  " in the URDF; remove the key, or write in the scene what is meant\n");
}

TEST(SceneOptions, StaticsLeavesOutVelocityTermsUnlessTheyAreAskedFor) {
  EXPECT_EQ(info({"--rates_zero", "true"}).err, "");
  EXPECT_EQ(info({"--rates_zero", "true", "--outputs", "bias"}).err, "");
  EXPECT_EQ(info({"--rates_zero", "true", "--outputs", "coriolis_matrix"}).status, 2);
}

}  // namespace
}  // namespace dalembert::test
