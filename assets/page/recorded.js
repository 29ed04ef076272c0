// A page that plays the runs embedded in it.

async function begin() {
    const message = document.getElementById("message");
    if (typeof DecompressionStream === "undefined") {
        message.textContent = "This browser is too old to play the run: it lacks DecompressionStream.";
        return;
    }
    try {
        const data = await unpacked("run-data").json();
        document.getElementById("player").hidden = false;
        window.wildfire = new Player(data);
        message.hidden = true;
    } catch (error) {
        message.textContent = `This page cannot play its run: ${error.message}`;
        throw error;
    }
}

begin();
