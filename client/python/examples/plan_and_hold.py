"""Plans a move, has a simulated axis follow it, holds and resumes it on the way, and plots what became of it.

    portamento-server & portamento-sim-axis &
    pip install './client/python[example]'
    python client/python/examples/plan_and_hold.py plan_and_hold.png
"""

import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import portamento

parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("plot", nargs="?", default="plan_and_hold.png", help="where to draw it")
parser.add_argument("--server", default="127.0.0.1:50051", help="the planner, as host:port")
parser.add_argument("--axis", default="127.0.0.1:50052", help="the axis simulator, as host:port")
asked = parser.parse_args()

server, axis = portamento.Server(asked.server), portamento.SimAxis(asked.axis)
limits = portamento.Limits(velocity=0.25, acceleration=3, jerk=100)
plan = server.plan(portamento.Move("x", 0.2, limits))
print(f"planned: {plan.duration:.4f} s, certificate {'passed' if plan.certificate.passed else 'failed'}")

times, planned, commanded, error = [], [], [], []
with axis.track(plan, "python/x", [f"http://{asked.server}"]) as run:
    hold = axis.hold("python/x", not_before=300)
    print(f"holds from cycle {hold.effective_cycle}, rests from {hold.rest_cycle}")
    resume = axis.resume("python/x", not_before=hold.rest_cycle + 200)
    print(f"goes on from cycle {resume.effective_cycle}")
    for samples in run:
        for n in range(samples.cycles):
            time = (samples.first_cycle + n) * plan.cycle_time
            times.append(time)
            planned.append(plan.at(time)[0])
            commanded.append(samples.position[0][n])
            error.append(samples.following_error[0][n] * 1e6)
card = run.report.axes[0]
print(f"followed within {card.max_following_error * 1e6:.3g} µm")

figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(8, 6))
above.plot(times, planned, "--", color="0.6", label="as planned")
above.plot(times, commanded, label="with hold and resume")
above.set_ylabel("Position [m]")
above.legend()
below.plot(times, error)
below.set_ylabel("Following error [µm]")
below.set_xlabel("Time [s]")
figure.savefig(asked.plot, dpi=120)
print(f"drawn: {asked.plot}")
