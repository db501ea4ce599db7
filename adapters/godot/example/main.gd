# A dog that walks behind a wall and back. With `-- --check` it ends once both were heard.
extends EchomarchSource

var time := 0.0
var phase := 0.0
var was_seen := false
var was_hidden := false


func _process(delta: float) -> void:
	time += delta
	position.z = -2.0 + 2.0 * sin(time)
	var samples := PackedFloat32Array()
	for index in samples_wanted():
		phase += TAU * 440.0 / AudioServer.get_mix_rate()
		samples.append(0.2 * sin(phase))
	push_samples(samples)
	var now := heard()
	if not now.is_empty():
		was_seen = was_seen or now["is_in_sight"]
		was_hidden = was_hidden or not now["is_in_sight"]
	if "--check" in OS.get_cmdline_user_args() and ((was_seen and was_hidden) or time > 60.0):
		print("in sight: %s, hidden: %s" % [was_seen, was_hidden])
		get_tree().quit(0 if was_seen and was_hidden else 1)
