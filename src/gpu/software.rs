//! Recognises renderers that draw with the processor by their names.

/// Parts of the names of renderers that draw with the processor, in lower case.
const SOFTWARE_RENDERERS: [&str; 12] = [
    // Mesa's; also as "zink (llvmpipe ...)" and "virgl (LLVMPIPE ...)".
    "llvmpipe",
    "lavapipe",
    "softpipe",
    "swrast",
    "software rasterizer",
    "openswr",
    "swr (",
    // ANGLE and Vulkan in browsers.
    "swiftshader",
    "apple software renderer",
    // WARP, through ANGLE or as Mesa's "D3D12 (Microsoft Basic Render Driver)".
    "microsoft basic render driver",
    "warp",
    // Windows without a driver: OpenGL 1.1.
    "gdi generic",
];

/// Whether a renderer of that name draws with the processor.
pub(super) fn is_software(renderer: &str) -> bool {
    let renderer = renderer.to_lowercase();
    SOFTWARE_RENDERERS
        .iter()
        .any(|name| renderer.contains(name))
}

#[cfg(test)]
mod tests {
    use super::is_software;

    /// Protects recognising a software renderer by its name, which decides on wall clock or timer query, goldens or
    /// tolerances.
    #[test]
    fn software_renderers_are_known_by_name() {
        for software in [
            "llvmpipe (LLVM 15.0.6, 256 bits)",
            "zink (llvmpipe (LLVM 15.0.6, 256 bits))",
            "zink Vulkan 1.3(llvmpipe (LLVM 19.1.7, 256 bits) (MESA_LLVMPIPE))",
            "virgl (LLVMPIPE (LLVM 15.0.6, 256 bits))",
            "softpipe",
            "SWR (LLVM 10.0, AVX2)",
            "Software Rasterizer",
            "Google SwiftShader",
            "ANGLE (Google, Vulkan 1.3.0 (SwiftShader Device (Subzero)), SwiftShader driver)",
            "ANGLE (Microsoft, Microsoft Basic Render Driver Direct3D11 vs_5_0 ps_5_0)",
            "D3D12 (Microsoft Basic Render Driver)",
            "Apple Software Renderer",
            "GDI Generic",
        ] {
            assert!(is_software(software), "{software}");
        }
        for hardware in [
            "NVIDIA H200/PCIe/SSE2",
            "Mesa Intel(R) UHD Graphics 620 (KBL GT2)",
            "AMD Radeon RX 6800 (radeonsi, navi21, LLVM 15.0.6, DRM 3.49)",
            "zink Vulkan 1.3(NVIDIA GeForce RTX 4090 (NVIDIA_PROPRIETARY))",
            "virgl (AMD Radeon RX 6800 (radeonsi, navi21))",
            "Apple M2 Pro",
            "ANGLE (Intel, Intel(R) UHD Graphics 620 Direct3D11 vs_5_0 ps_5_0, D3D11)",
        ] {
            assert!(!is_software(hardware), "{hardware}");
        }
    }
}
