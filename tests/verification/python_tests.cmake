# SPDX-License-Identifier: BSD-3-Clause
haptos_add_python_test(from_gmsh SCRIPT ${CMAKE_CURRENT_SOURCE_DIR}/from_gmsh_test.py LABELS verification TIMEOUT 300)
haptos_add_python_test(dovetail_mesh SCRIPT ${CMAKE_CURRENT_SOURCE_DIR}/dovetail_mesh_test.py LABELS verification TIMEOUT 60)
haptos_add_python_test(gmsh_elements LABELS verification TIMEOUT 300
         SCRIPT ${CMAKE_CURRENT_SOURCE_DIR}/gmsh_elements_test.py --haptos $<TARGET_FILE:haptos_program>)

# A result of the program, in VTK's reader (ParaView's): sets, time step and all fields by name.
set(result ${CMAKE_CURRENT_BINARY_DIR}/fields_result.exo)
haptos_add_run(result_for_vtk LABELS verification RANKS 2 TIMEOUT 120 TEXT "converged: kkt"
         COMMAND ${HAPTOS_MPIRUN} -n 2 $<TARGET_FILE:haptos_program> ${PROJECT_SOURCE_DIR}/inputs/table31.xml
                 --set "Mesh->Two Beams->Subdomains Per Edge=1" --set "Mesh->Two Beams->Elements Per Subdomain Edge=2"
                 --output ${result} --summary ${CMAKE_CURRENT_BINARY_DIR}/fields_summary.json)
set_tests_properties(result_for_vtk PROPERTIES FIXTURES_SETUP result_for_vtk)
haptos_add_python_test(result_in_vtk LABELS verification TIMEOUT 120
         SCRIPT ${CMAKE_CURRENT_SOURCE_DIR}/exodus_in_vtk.py ${result}
                 --blocks lower upper --side-sets lower_contact upper_contact lower_clamp upper_clamp upper_top lower_bottom upper_end
                 --nodal displacement_x displacement_y displacement_z contact_force_x contact_force_y contact_force_z
                         contact_normal_force contact_pressure contact_gap contact_slip_x contact_slip_y contact_slip_z
                         contact_status friction_axis_x friction_axis_y friction_axis_z
                 --element stress_xx stress_yy stress_zz stress_xy stress_yz stress_zx von_mises subdomain
                 --global kkt hessian_multiplications --times 1 --elements 32 --nodes 90)
set_tests_properties(result_in_vtk PROPERTIES FIXTURES_REQUIRED result_for_vtk)

# The charts, from a few small runs.
haptos_add_python_test(chart LABELS verification TIMEOUT 600
         SCRIPT ${CMAKE_CURRENT_SOURCE_DIR}/chart_test.py --haptos $<TARGET_FILE:haptos_program> --scenes-test $<TARGET_FILE:scenes_test>)

# Scenes with known answers (doc/verification), the smallest variant of each; examples.
foreach(kind Small Large Examples)
  string(TOLOWER ${kind} name)
  haptos_add_python_test(benchmarks_${name} LABELS verification TIMEOUT 600
           SCRIPT ${CMAKE_CURRENT_SOURCE_DIR}/benchmarks/benchmarks_test.py --haptos $<TARGET_FILE:haptos_program> ${kind})
endforeach()
set_tests_properties(benchmarks_large PROPERTIES LABELS "verification;slow")
haptos_add_python_test(benchmarks_calculix LABELS "verification;slow" TIMEOUT 600
         SCRIPT ${CMAKE_CURRENT_SOURCE_DIR}/benchmarks/calculix.py --haptos $<TARGET_FILE:haptos_program>)
