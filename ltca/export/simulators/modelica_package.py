"""A reduced drive as a Modelica 4 package: a component between the flanges of input and output."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


def _row(values: Iterable[float]) -> str:
    return "{" + ", ".join(f"{float(value):.9g}" for value in values) + "}"


def _vector(values: list[float]) -> str:
    """A vector with its size, which Modelica cannot tell of an empty one."""
    return _row(values) if values else "fill(0.0, 0)"


def _matrix(rows: list[list[float]], columns: int) -> str:
    return "{" + ",\n      ".join(map(_row, rows)) + "}" if rows else f"fill(0.0, 0, {columns})"


def modelica_text(tables: dict[str, Any]) -> str:
    """Return the package.

    Parameters
    ----------
    tables : dict
        Content of the JSON file of the drive, with its name.
    """
    name, wind_up, friction, loop = tables["name"], tables["wind_up"], tables["friction"], tables["hysteresis"]
    orders, around, limits, inertia = wind_up["orders"], loop["factor_orders"], tables["limits"], tables["inertia"]
    nodes, worst = len(wind_up["torque_N_m"]), tables["fit_error"]["worst"]
    damping, rotor = tables["damping"]["at_output_N_m_s_per_rad"] or 0.0, inertia["at_input_kg_m2"]
    told = f"{tables['drive']} {tables['case']}, fingerprint {tables['fingerprint']}, cyclo {tables['cyclo_version']}"
    told = told.replace("\\", "\\\\").replace('"', '\\"')
    rotor_words = (
        "inertia of the drive at its input"
        if rotor is not None
        else "densities are not given: the drive has no inertia here"
    )
    return f"""within ;
package {name} "{told}"

  function interpolate "Linear between the points of an ascending table, and beyond its ends"
    input Real x;
    input Real at[:];
    input Real value[size(at, 1)];
    output Real y;
  protected
    Integer j;
  algorithm
    j := 1;
    while j < size(at, 1) - 1 and at[j + 1] < x loop
      j := j + 1;
    end while;
    y := if at[j + 1] > at[j] then value[j] + (x - at[j])/(at[j + 1] - at[j])*(value[j + 1] - value[j]) else value[j];
  end interpolate;

  function windUpNodes "Wind-up at the torques of the table"
    input Real phase "Crank angle";
    input Real mean[:];
    input Real order[:];
    input Real cosine[size(order, 1), size(mean, 1)];
    input Real sine[size(order, 1), size(mean, 1)];
    output Real node[size(mean, 1)];
  algorithm
    for j in 1:size(mean, 1) loop
      node[j] := mean[j];
      for k in 1:size(order, 1) loop
        node[j] := node[j] + cosine[k, j]*cos(order[k]*phase) + sine[k, j]*sin(order[k]*phase);
      end for;
      if j > 1 then
        node[j] := max(node[j], node[j - 1]);
      end if;
    end for;
  end windUpNodes;

  function strengthFactor "Of the elements over the crank angle, less one"
    input Real phase "Crank angle";
    input Real order[:];
    input Real ends[size(order, 1), 2] "Cosine and sine";
    output Real y;
  algorithm
    y := 0;
    for k in 1:size(order, 1) loop
      y := y + ends[k, 1]*cos(order[k]*phase) + ends[k, 2]*sin(order[k]*phase);
    end for;
  end strengthFactor;

  model Drive "Valid to {limits["peak_torque_N_m"]:g} N.m; within {100.0 * worst["part_of_torque_range"]:.2g} % of the torque range of the analysis"
    extends Modelica.Mechanics.Rotational.Interfaces.PartialTwoFlanges;
    parameter Real ratio = {tables["transmission_ratio"]:.12g} "Turns of flange_a (input) for one of flange_b (output)";
    parameter Real cranks = {tables["crank_turns_per_input_turn"]:.12g} "Turns of the crank for one of the input";
    parameter Modelica.Units.SI.Torque rated = {limits["rated_torque_N_m"]:.9g};
    parameter Modelica.Units.SI.Inertia J = {0.0 if rotor is None else rotor:.9g} "{rotor_words}";
    parameter Modelica.Units.SI.RotationalDampingConstant d = {damping:.9g} "{tables["damping"]["words"]}";
    parameter Modelica.Units.SI.Time settling = 1e-4 "Time in which friction follows, short beside the vibrations of interest";
    parameter Modelica.Units.SI.AngularVelocity creep = 0.1 "Speed of the input at which its friction is fully there";
    constant Real torqueAt[{nodes}] = {_row(wind_up["torque_N_m"])};
    constant Real mean[{nodes}] = {_row(wind_up["mean_rad"])};
    constant Real order[{len(orders)}] = {_vector([one["order"] for one in orders])};
    constant Real cosine[{len(orders)}, {nodes}] = {_matrix([one["cos_rad"] for one in orders], nodes)};
    constant Real sine[{len(orders)}, {nodes}] = {_matrix([one["sin_rad"] for one in orders], nodes)};
    constant Real flank[{len(loop["flank"])}] = {_vector(loop["flank"])};
    constant Real exponent[size(flank, 1)] = {_vector(loop["exponent"])};
    constant Real strength[{len(loop["strength"])}] = {_vector(loop["strength"])};
    constant Real stiffness[{len(loop["stiffness"])}] = {_vector(loop["stiffness"])};
    constant Real weightOrder[size(strength, 1)] = {_vector(loop["weight_order"])};
    constant Real weightAmplitude[size(strength, 1)] = {_vector(loop["weight_amplitude"])};
    constant Real weightPhase[size(strength, 1)] = {_vector(loop["weight_phase_rad"])};
    constant Real factorOrder[{len(around)}] = {_vector([one["order"] for one in around])};
    constant Real factorCcw[{len(around)}, 2] = {_matrix([[one["cos_ccw"], one["sin_ccw"]] for one in around], 2)};
    constant Real factorCw[{len(around)}, 2] = {_matrix([[one["cos_cw"], one["sin_cw"]] for one in around], 2)};
    constant Real frictionAt[{len(friction["torque_N_m"])}] = {_row(friction["torque_N_m"])};
    constant Real frictionCcw[size(frictionAt, 1)] = {_row(friction["at_input_turning_ccw_N_m"])};
    constant Real frictionCw[size(frictionAt, 1)] = {_row(friction["at_input_turning_cw_N_m"])};
    Modelica.Units.SI.Angle windUp;
    Modelica.Units.SI.Torque elastic "Without hysteresis";
    Modelica.Units.SI.Torque followed(start = 0, fixed = true) "The same, filtered";
    Modelica.Units.SI.Torque element[size(strength, 1)](each start = 0, each fixed = true) "Maxwell-slip elements";
    Modelica.Units.SI.Torque most[size(strength, 1)] "At which they slip";
    Modelica.Units.SI.Torque load[size(strength, 1)] "On the flank of each, not negative";
    Real factor[2] "Of all their strengths and stiffnesses, by the flank";
    Real weight[size(strength, 1)] "Factor with what each has of its own";
    Modelica.Units.SI.Torque torque "With which the output is held";
    Modelica.Units.SI.Torque friction "At the input";
    Modelica.Units.SI.AngularVelocity w "Of the input";
  equation
    windUp = flange_b.phi - flange_a.phi/ratio;
    w = der(flange_a.phi);
    elastic = interpolate(windUp, windUpNodes(cranks*flange_a.phi, mean, order, cosine, sine), torqueAt);
    settling*der(followed) = elastic - followed;
    factor[1] = max(0, 1 + strengthFactor(cranks*flange_a.phi, factorOrder, factorCcw));
    factor[2] = max(0, 1 + strengthFactor(cranks*flange_a.phi, factorOrder, factorCw));
    for e in 1:size(strength, 1) loop
      weight[e] = (if flank[e] > 0 then factor[1] else factor[2])
        *(1 + weightAmplitude[e]*cos(weightOrder[e]*cranks*flange_a.phi - weightPhase[e]));
      load[e] = max(0, flank[e]*followed);
      most[e] = weight[e]*strength[e]*rated*(load[e]/rated)^exponent[e];
      der(element[e]) = (if load[e] > 0 then weight[e]*stiffness[e]*flank[e]*(elastic - followed)/settling else 0)
        - max(0, element[e] - most[e])/settling + max(0, -most[e] - element[e])/settling;
    end for;
    torque = elastic + flank*element + d*der(windUp);
    friction = tanh(w/creep)*(if w > 0 then interpolate(followed, frictionAt, frictionCcw)
      else interpolate(followed, frictionAt, frictionCw));
    flange_b.tau = torque;
    flange_a.tau = J*der(w) + friction - torque/ratio;
    annotation(Documentation(info = "<html><p>Quasi-static tables of cyclo; wind-up with play and transmission error, hysteresis,
      friction by the load. Angles in rad, ccw positive, against the held member.</p></html>"));
  end Drive;

  annotation(uses(Modelica(version = "4.0.0")));
end {name};
"""
