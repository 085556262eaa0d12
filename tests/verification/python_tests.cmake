# SPDX-License-Identifier: BSD-3-Clause
# Tests in Python.  They take the python3 that is first on PATH when they run: `bootstrap.sh test` puts build/venv there.
# Where a package is missing they end with status 77 and count as skipped.
set(HAPTOS_PYTHON "" CACHE FILEPATH "Python for the tests; empty: the first python3 on PATH when they run")
set(python /usr/bin/env python3)
if(HAPTOS_PYTHON)
  set(python ${HAPTOS_PYTHON})
endif()

add_test(NAME from_gmsh COMMAND ${python} ${CMAKE_CURRENT_SOURCE_DIR}/from_gmsh_test.py)
set_tests_properties(from_gmsh PROPERTIES LABELS verification TIMEOUT 300 SKIP_RETURN_CODE 77)

# A result of the program, in VTK's reader (ParaView's): sets, time step and all fields by name.
set(result ${CMAKE_CURRENT_BINARY_DIR}/fields_result.exo)
add_test(NAME result_for_vtk
         COMMAND ${HAPTOS_MPIRUN} -n 2 $<TARGET_FILE:haptos_program> ${PROJECT_SOURCE_DIR}/inputs/table31.xml
                 --set "Mesh->Two Beams->Subdomains Per Edge=1" --set "Mesh->Two Beams->Elements Per Subdomain Edge=2"
                 --output ${result} --summary ${CMAKE_CURRENT_BINARY_DIR}/fields_summary.json)
set_tests_properties(result_for_vtk PROPERTIES LABELS verification FIXTURES_SETUP result_for_vtk PROCESSORS 2 TIMEOUT 120
  ENVIRONMENT "OPENBLAS_NUM_THREADS=1;OMPI_ALLOW_RUN_AS_ROOT=1;OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1")
add_test(NAME result_in_vtk
         COMMAND ${python} ${CMAKE_CURRENT_SOURCE_DIR}/exodus_in_vtk.py ${result}
                 --blocks lower upper --side-sets lower_contact upper_contact lower_clamp upper_clamp upper_top lower_bottom upper_end
                 --nodal displacement_x displacement_y displacement_z contact_force_x contact_force_y contact_force_z
                         contact_normal_force contact_pressure contact_gap contact_slip_x contact_slip_y contact_slip_z
                         contact_status friction_axis_x friction_axis_y friction_axis_z
                 --element stress_xx stress_yy stress_zz stress_xy stress_yz stress_zx von_mises subdomain
                 --global kkt hessian_multiplications --times 1 --elements 32 --nodes 90)
set_tests_properties(result_in_vtk PROPERTIES LABELS verification FIXTURES_REQUIRED result_for_vtk TIMEOUT 120
  SKIP_RETURN_CODE 77)

# The charts, from a few small runs.
add_test(NAME chart COMMAND ${python} ${CMAKE_CURRENT_SOURCE_DIR}/chart_test.py --haptos $<TARGET_FILE:haptos_program>
         --scenes-test $<TARGET_FILE:scenes_test>)
set_tests_properties(chart PROPERTIES LABELS verification TIMEOUT 600 SKIP_RETURN_CODE 77)
